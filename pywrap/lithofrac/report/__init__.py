"""Pages of the report, filled with the tables that the pipeline made."""

from lithofrac.report.write import write_report

__all__ = ["write_report"]
