"""Answer in words and numbers, the same in pictures, tables and notes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from wiggleroom.drawing.model import Closer, Goal, Pull, Towards, Translation, Turn, Vector, W, Weight
from wiggleroom.verdict import PathState, SearchState, Verdict

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.drawing.model import Goal
    from wiggleroom.search.answer import Answer, Contact

MAX_NAME_LENGTH = 40
"""Longer names are cut in the middle [characters]."""
MIN_MOTION = 1e-12
"""Parts that never move further are left out of paths [mm, rad]."""
MAX_GOALS = 4
"""Goals that a headline names; the others are counted."""
_SENTENCES_IN_SPACE = {
    Verdict.OPTIMAL: "the optimality conditions hold, contacts balance the pull",
    Verdict.STATIONARY: "the optimality conditions of first order hold, but there is a direction that curves upwards",
}


def number(value: float, digits: int = 4) -> str:
    """`value` to `digits` significant digits, without an exponent wherever that stays readable.

    >>> number(1.37234), number(0.00012345), number(-0.0), number(25000.0), number(1e99)
    ('1.372', '0.0001234', '0', '25000', '1.000e+99')
    """
    if value == 0 or not math.isfinite(value):
        return "0" if value == 0 else str(value)
    places = digits - 1 - math.floor(math.log10(abs(value)))
    if not -12 < places <= 12:
        return f"{value:.{digits - 1}e}"
    rounded = f"{value:.{max(places, 0)}f}"
    return rounded.rstrip("0").rstrip(".") if "." in rounded else rounded


def short(name: str) -> str:
    """Part's name, its middle left out where it is very long."""
    half = MAX_NAME_LENGTH // 2
    return name if len(name) <= MAX_NAME_LENGTH else f"{name[: half - 1]}…{name[-half:]}"


def towards(direction: Iterable[float]) -> str:
    """Direction as people write it, in the plane or in space.

    >>> towards((0.0, 2.0)), towards((3.0, 4.0)), towards((0.0, 3.0, 4.0)), towards((0.0, 0.0, -1e300))
    ('+y', '(0.6, 0.8)', '(0, 0.6, 0.8)', '-z')
    """
    numbers = list(direction)
    largest = max(map(abs, numbers))
    length = math.hypot(*(x / largest for x in numbers))
    unit = [x / largest / length for x in numbers]
    for k, axis in enumerate("xyz"[: len(unit)]):
        if max(abs(x) for x in (*unit[:k], *unit[k + 1 :])) < 1e-9:
            return ("+" if unit[k] > 0 else "-") + axis
    return f"({', '.join(number(x, 3) for x in unit)})"


def sense_text(sense: str | Vector) -> str:
    """Sense of a turn as people write it.

    >>> sense_text("ccw"), sense_text((0.0, 0.0, 1.0))
    ('ccw', 'about +z')
    """
    return sense if isinstance(sense, str) else f"about {towards(sense)}"


def goal_text(goal: Goal) -> str:
    """One goal in a few words: the part and the direction in which it is pulled or turned."""
    match goal:
        case Pull():
            return f"{short(goal.part)} in {towards(goal.direction)}"
        case Turn():
            return (
                f"{'turn' if isinstance(goal.sense, str) else 'twist'} of {short(goal.part)} {sense_text(goal.sense)}"
            )
        case W():
            return f"{short(goal.part)} along w = ({', '.join(number(x, 3) for x in goal.w)})"
        case Towards(target=(x, y)):
            return f"{short(goal.part)} towards ({number(x)}, {number(y)})"
        case Translation():
            return "sum of squared translations"
        case Closer():
            return "neighbours closer"
        case Weight():
            return f"weight towards {towards(goal.direction)}"


def goals_text(goals: tuple[Goal, ...], most: int = 1) -> str:
    """Goals in a row; of several the first ones.

    >>> goals_text((Pull("a", (0, 1)), Pull("b", (0, 1))))
    'a in +y and 1 more'
    """
    more = f" and {len(goals) - most} more" if len(goals) > most else ""
    return ", ".join(goal_text(g) for g in goals[:most]) + more


def assembly_lines(assembly: Assembly) -> list[str]:
    """What an assembly is, in two lines: its size and gap, then what stands and what is asked."""
    fixed = [part.name for part in assembly.parts if part.fixed]
    stands = f"{few(fixed)} {'stands' if len(fixed) == 1 else 'stand'}" if fixed else "nothing stands"
    wanted = f"asked: {goals_text(assembly.goals, 3)}" if assembly.goals else "nothing is asked"
    return [f"{len(assembly.parts)} parts, gap {number(assembly.gap)} mm", f"{stands}; {wanted}"]


def unit(goals: tuple[Goal, ...]) -> str:
    """Say the unit of the objective: mm, rad, mm² or nothing where goals of several kinds add up."""
    if all(isinstance(g, Towards | Translation | Closer) for g in goals):
        return "mm²"
    if all(isinstance(g, Pull) or (isinstance(g, W) and g.w[2] == 0) for g in goals):
        return "mm"
    if all(isinstance(g, Turn) or (isinstance(g, W) and g.w[:2] == (0, 0)) for g in goals):
        return "rad"
    return ""


def per_gap(goals: tuple[Goal, ...]) -> str:
    """Unit of what a little more gap is worth."""
    return f"{unit(goals)} per mm of gap".strip()


def headline(answer: Answer) -> str:
    """Say what was found, in one line, such as "b10 moves 1.372 mm in +y"."""
    goals, value = answer.goals, answer.objective
    if not goals:
        return f"{len(answer.assembly.parts)} parts, nothing asked"
    if value is None:
        return f"nothing stops {goals_text(goals)}"
    if len(goals) == 1:
        goal = goals[0]
        own = value / goal.weight if goal.weight else value
        match goal:
            case Pull():
                place = "" if goal.point is None else f" at ({', '.join(number(x) for x in goal.point)})"
                return f"{short(goal.part)}{place} moves {number(own)} mm in {towards(goal.direction)}"
            case Turn():
                return f"{short(goal.part)} turns {number(math.degrees(own))}° {sense_text(goal.sense)}"
            case Towards(target=(x, y)):
                return f"{short(goal.part)} towards ({number(x)}, {number(y)}): the squared distance loses {number(own)} mm²"
            case Translation():
                return f"sum of squared translations {number(own)} mm²"
            case Closer():
                return f"neighbours closer: their squared distances lose {number(own)} mm²"
            case Weight():
                return f"sum of volume times density times sinking {number(own)}, towards {towards(goal.direction)}"
    return f"{number(value)} {unit(goals)}".strip() + f": {goals_text(goals, MAX_GOALS)}"


def verdict_sentence(answer: Answer) -> str:
    """Say what the verdict means; of a model that approximates the free space, what it does not."""
    if answer.period is not None:
        return f"{answer.verdict.sentence}: {repeats(answer)}"
    if answer.assembly.dimension == 3:
        return _SENTENCES_IN_SPACE.get(answer.verdict, answer.verdict.sentence)
    if answer.model == "walls" or answer.verdict is Verdict.UNBOUNDED:
        return answer.verdict.sentence
    end = "reached its end" if answer.verdict is Verdict.STATIONARY else "stopped before its end"
    truth = "this motion does not overlap" if answer.collision_free else "the parts overlap in this motion"
    return f"the model {answer.model} {end}; it only approximates the contacts: {truth}"


def repeats(answer: Answer) -> str:
    """Say after which turns a motion begins anew, such as "it repeats after gear0 21.18°, gear1 -15.65°"; empty where it does not."""
    if answer.period is None:
        return ""
    turned = [(name, math.degrees(turn)) for name, turn in zip(answer.assembly.names, answer.period.turn, strict=True)]
    return f"it repeats after {few([f'{short(name)} {number(turn)}°' for name, turn in turned if turn], 4)}"


def proven(answer: Answer) -> str:
    """Say between which values the largest motion lies, "between 1.372 and 1.379 mm, proven"; nothing where that is not known.

    The lower value is rounded down and the upper one up. Of a quick bound, which nobody asked for, only "at most 1.412 mm".
    """
    value, most = answer.objective, answer.at_most
    if value is None or most is None:
        return ""
    what, factor = unit(answer.goals), 1.0
    if len(answer.goals) == 1 and isinstance(answer.goals[0], Turn):
        what, factor = "°", math.degrees(1.0)
    if len(answer.goals) == 1 and answer.goals[0].weight > 0:
        factor /= answer.goals[0].weight
    value, most = value * factor, most * factor
    apart = max(most - value, 1e-5 * abs(most), 1e-12)
    places = max(0, min(12, 1 - math.floor(math.log10(apart))))
    low, high = (round_(v * 10**places) / 10**places for round_, v in ((math.floor, value), (math.ceil, most)))
    space = "" if what in ("", "°") else " "
    if answer.bound is not None and answer.bound.kind == "quick":
        return f"at most {high:.{places}f}{space}{what}"
    return f"between {low:.{places}f} and {high:.{places}f}{space}{what}, proven"


def rounded_up(value: float) -> str:
    """A bound to four digits, never less than it is.

    >>> rounded_up(1.37231), rounded_up(1234567.0), rounded_up(0.5)
    ('1.373', '1235000', '0.5')
    """
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    places = 3 - math.floor(math.log10(abs(value)))
    high = math.ceil(value * 10.0**places) / 10.0**places
    return f"{high:.{max(places, 0)}f}".rstrip("0").rstrip(".") if places > 0 else f"{high:.0f}"


def bound_sentence(answer: Answer) -> str:
    """Say what was proven about the largest motion, how near it comes and what it took; or why nothing was."""
    if answer.assembly.dimension == 3 and (answer.bound is None or answer.bound.at_most is None):
        return _bound_in_space(answer)
    bound, between = answer.bound, proven(answer)
    if not between:
        return f"no bound: {bound.why}" if bound is not None and bound.why else "not worked out"
    near = "" if bound is None or bound.within is None else f", within {number(100 * bound.within, 2)} % of the answer"
    spent = "" if bound is None else f", in {bound.seconds:.1f} s"
    return between + near + spent + (f"; no nearer one: {bound.why}" if bound is not None and bound.why else "")


def _bound_in_space(answer: Answer) -> str:
    if answer.at_most is not None and answer.bound is None:
        return f"{rounded_up(answer.at_most)} {unit(answer.goals)}, as a cross-section shows".replace(" ,", ",")
    if answer.bound is not None and answer.bound.why:
        return f"no bound: {answer.bound.why}"
    return "no bound was found; one is worked out where all parts are locked to one plane, and by --prove"


def searched(answer: Answer) -> str:
    """Say how many starts were made, how many ended at the value reported, and the best value but one."""
    effort = answer.search
    if effort is None:
        if answer.verdict in (Verdict.PROVEN, Verdict.UNBOUNDED):
            return "from rest only"
        unfound = "a better local optimum may remain unfound"
        hint = "--search 8 may find a better local optimum"
        return f"from rest only; {hint if answer.assembly.dimension == 3 else unfound}"
    if effort.starts == 1:
        return "1 start"
    ends = f"{effort.starts} starts, {effort.at_value} ended at this value"
    return ends if effort.next_best is None else f"{ends}; the best of the others at {number(effort.next_best, 4)}"


def solved(answer: Answer) -> str:
    """Say which solver answered, on which model, and what it took."""
    rounds = f"{answer.rounds} round{'s' * (answer.rounds != 1)}"
    return f"{answer.solver} on {answer.model}, {rounds}, {answer.iterations} iteration{'s' * (answer.iterations != 1)}"


def answer_sure(answer: Answer) -> list[tuple[str, str]]:
    """How sure an answer is, and what it cost: a word and a sentence each."""
    found = "nothing stops it" if answer.objective is None else f"{number(answer.objective, 6)} {unit(answer.goals)}"
    if answer.objective is not None and unit(answer.goals) == "rad":
        found += f", {number(math.degrees(answer.objective))}°"
    state = answer.search_state
    verdict, search = f"{answer.verdict.value}: {verdict_sentence(answer)}", searched(answer)
    if state is not SearchState.DONE:
        verdict = f"{state.found}: {state.sentence}; of the climb from rest: {verdict}"
        search = f"from rest only; {state.sentence}"
    return [
        ("found", found.strip()),
        ("verdict", verdict),
        ("checked", f"{certainty(answer)}; deepest overlap {number(answer.deepest_overlap, 2)} mm"),
        ("at most", bound_sentence(answer)),
        ("search", search),
        ("solved", solved(answer)),
        ("seconds", ", ".join(f"{stage} {spent:.2f}" for stage, spent in answer.seconds.items())),
    ]


def force_bearing_contacts(contacts: Iterable[Contact]) -> list[Contact]:
    """Contacts with a force, the strongest first; equal ones in an order that does not change."""
    return sorted((c for c in contacts if c.force > 0), key=lambda c: (-c.force, c.parts, c.point))


def certainty(answer: Answer) -> str:
    """Say what was checked about the motion, in a few words."""
    if not answer.collision_free:
        return f"parts overlap by {number(answer.deepest_overlap, 2)} mm"
    return (
        "no overlap, path from rest checked"
        if answer.path == PathState.CHECKED
        else "no overlap, path from rest not checked"
    )


def facts(answer: Answer) -> list[str]:
    """Facts under the headline: verdict, size of the question, and how sure it is."""
    if not answer.goals:
        return [f"gap {number(answer.assembly.gap)} mm"]
    found = [
        f"{answer.search_state.found or answer.verdict}",
        f"gap {number(answer.assembly.gap)} mm",
        f"{len(answer.assembly.parts)} parts",
    ]
    if answer.verdict is Verdict.UNBOUNDED and answer.leaves:
        found.append(f"leaves: {few(answer.leaves)}")
    if answer.verdict is Verdict.UNBOUNDED and answer.turns:
        found.append(f"turns: {few(answer.turns)}")
    said = (repeats(answer), proven(answer), certainty(answer))
    return [*found, *filter(None, said)]


def few(names: Sequence[str], most: int = 8) -> str:
    """Names in a row; of very many the first ones.

    >>> few(["a", "b", "c"], 2)
    'a, b and 1 more'
    """
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(short(n) for n in names[:most]) + more
