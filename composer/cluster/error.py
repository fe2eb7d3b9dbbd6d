"""The error for a cluster that cannot do the work."""

from __future__ import annotations

from composer.diagnostics.error import DiagnosticError


class ClusterError(DiagnosticError):
    """There is no cluster, it was lost, or one of its workers would make other models."""
