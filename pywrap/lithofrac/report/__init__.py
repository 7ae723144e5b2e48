"""Pages of the report, filled with the tables that the pipeline made."""

from lithofrac.report.gallery import write_gallery
from lithofrac.report.sheets import category_of, load_sheets
from lithofrac.report.write import write_report

__all__ = ["category_of", "load_sheets", "write_gallery", "write_report"]
