"""Showing a finished design: pictures, charts, reports and windows. Nothing is computed here."""
