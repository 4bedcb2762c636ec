"""Visibility in the plane: tile maps and floor plans. Exact but for rounding, which never hides."""

from ._casca import field_of_view, visible_region

__all__ = ["field_of_view", "visible_region"]
