"""What commands write with `--json`: one structure for each format, two where parts in space are told otherwise."""

from __future__ import annotations

from wiggleroom.schema.clearances_schema import ClearancesResult
from wiggleroom.schema.disassembly_schema import CheckResult
from wiggleroom.schema.flex_schema import FlexResult
from wiggleroom.schema.free_space_schema import SpaceResult
from wiggleroom.schema.gap_schema import GapResult, TolerancesResult
from wiggleroom.schema.listing_schema import AssembleResult, PartsResult
from wiggleroom.schema.plan_schema import PlanResult, SpatialPlanResult
from wiggleroom.schema.spatial_result_schema import SpatialCheckResult, SpatialFlexResult, SpatialPartsResult
from wiggleroom.schema.study_schema import RankResult, SampleResult, SweepResult, TightenResult

RESULTS = (
    FlexResult, CheckResult, PlanResult, GapResult, RankResult, TightenResult, SweepResult, SampleResult, TolerancesResult, SpaceResult,
    ClearancesResult, PartsResult, AssembleResult, SpatialFlexResult, SpatialCheckResult, SpatialPlanResult, SpatialPartsResult,
)  # fmt: skip
"""All results; one in space has the format of the plane's and `"dimension": 3` besides."""
