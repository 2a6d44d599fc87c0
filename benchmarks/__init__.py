"""Programs behind published figures and generated pages."""
