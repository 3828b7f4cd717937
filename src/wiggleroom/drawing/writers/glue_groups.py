"""Which parts are glued together, directly or through others: groups that share a part are one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence


def glue_groups(glue: Iterable[Sequence[str]]) -> dict[str, int]:
    """Find the group of every glued part: the number of the first statement about any of its members.

    Examples
    --------
    >>> glue_groups([("a", "b"), ("c", "d"), ("b", "e")])
    {'a': 0, 'b': 0, 'c': 1, 'd': 1, 'e': 0}
    """
    parent: list[int] = []
    group: dict[str, int] = {}

    def root(number: int) -> int:
        while parent[number] != number:
            parent[number] = parent[parent[number]]
            number = parent[number]
        return number

    for number, names in enumerate(glue):
        parent.append(number)
        for name in names:
            one, other = sorted((root(group.setdefault(name, number)), root(number)))
            parent[other] = one
    return {name: root(number) for name, number in group.items()}


def glued_names(glue: Iterable[Sequence[str]]) -> list[list[str]]:
    """Return the names of the parts of every group.

    Examples
    --------
    >>> glued_names([("a", "b"), ("c", "d"), ("b", "e")])
    [['a', 'b', 'e'], ['c', 'd']]
    """
    members: dict[int, list[str]] = {}
    for name, number in glue_groups(glue).items():
        members.setdefault(number, []).append(name)
    return list(members.values())


def collidable(glue: Iterable[Sequence[str]], ignore: Iterable[Sequence[str]]) -> Callable[[str, str], bool]:
    """Whether two parts may not overlap: they are neither glued nor ignored.

    Examples
    --------
    >>> can = collidable([("a", "b")], [("c", "a")])
    >>> can("a", "b"), can("a", "c"), can("b", "c")
    (False, False, True)
    """
    group, ignored = glue_groups(glue), {frozenset(pair) for pair in ignore}
    return lambda a, b: not (frozenset((a, b)) in ignored or (a in group and group[a] == group.get(b)))


def body_numbers(names: Iterable[str], glue: Iterable[Sequence[str]]) -> list[int]:
    """Number the rigid bodies in the order of their first parts, and return that of every part.

    Examples
    --------
    >>> body_numbers("abcde", [("a", "b"), ("b", "e")])
    [0, 0, 1, 2, 0]
    """
    group = glue_groups(glue)
    known: dict[int | str, int] = {}
    return [known.setdefault(group.get(name, name), len(known)) for name in names]
