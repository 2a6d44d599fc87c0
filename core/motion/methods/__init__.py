"""Every method of motion: one file each, and one line here."""

from vibrafeed.core.motion.method import Method
from vibrafeed.core.motion.methods import rows, tumbling
from vibrafeed.core.motion.methods.events import EVENTS
from vibrafeed.core.motion.methods.reference import REFERENCE
from vibrafeed.core.motion.methods.regularised import BDF, LSODA, RADAU
from vibrafeed.core.motion.methods.rolling import rolled
from vibrafeed.core.motion.methods.stepping import TIME_STEPPING

METHODS: dict[str, dict[str, Method]] = {
    "conveying": {
        "events": EVENTS,
        "time-stepping": TIME_STEPPING,
        "reference": REFERENCE,
        "regularised": RADAU,
        "regularised-BDF": BDF,
        "regularised-LSODA": LSODA,
    },
    "tumbling": {
        "events": tumbling.EVENTS,
        "time-stepping": tumbling.TIME_STEPPING,
    },
    "row": {"events": rows.EVENTS, "time-stepping": rows.TIME_STEPPING},
    "rolling": rolled({"events": EVENTS, "time-stepping": TIME_STEPPING, "reference": REFERENCE}),
}
"""The methods by what they follow: a conveyed part, one that tumbles, a row, a round part."""
