"""The problems of the sweep; heavy ones stand last."""

from lithofrac.accuracy.problems import cases, contacts, cylinder, elastic, fracture, material_point
from lithofrac.accuracy.subject import Subject

SUBJECTS: dict[str, Subject] = {
    subject.name: subject
    for subject in (
        material_point.MATERIAL_POINT,
        elastic.BAR_WAVE,
        elastic.KIRSCH,
        cylinder.CYLINDER,
        contacts.BAR_IMPACT,
        fracture.CRACK_BAND,
        contacts.HERTZ,
        cases.SANDSTONE,
        cases.HOLE,
        cases.PUNCH,
    )
}
