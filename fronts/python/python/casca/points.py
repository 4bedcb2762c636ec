"""The points of a cloud that can be seen. Estimates: points are samples of an unknown surface."""

from ._casca import hidden_point_removal, splat_visible

__all__ = ["hidden_point_removal", "splat_visible"]
