"""Every method of motion: one file each, and one line here."""

from vibrafeed.core.motion.method import Method
from vibrafeed.core.motion.methods import rows, tumbling
from vibrafeed.core.motion.methods.events import EVENTS
from vibrafeed.core.motion.methods.reference import REFERENCE
from vibrafeed.core.motion.methods.rolling import rolled

METHODS: dict[str, dict[str, Method]] = {
    "conveying": {"events": EVENTS, "reference": REFERENCE},
    "tumbling": {"events": tumbling.EVENTS},
    "row": {"events": rows.EVENTS},
    "rolling": rolled({"events": EVENTS, "reference": REFERENCE}),
}
"""The methods by what they follow: a conveyed part, one that tumbles, a row, a round part."""
