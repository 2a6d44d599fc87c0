"""x."""
from vibrafeed._packages import claim
claim("core")
from core import __version__
