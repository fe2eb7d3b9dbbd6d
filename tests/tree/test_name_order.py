"""Looks in an order of names, compared with a look at each name."""

from __future__ import annotations

import random

from mjcompose.tree.name_order import NameOrder


def test_names_are_found_after_any_changes() -> None:
    chance = random.Random(3)
    names = {f"{chance.choice('ab/é')}{number % 40}{chance.choice(['', '/x', chr(0x10FFFF)])}" for number in range(90)}
    order = NameOrder(names)
    for _ in range(300):
        name = f"{chance.choice('ab')}{chance.randrange(40)}"
        if chance.random() < 0.5:
            names.add(name)
            order.add(name)
        else:
            names.discard(name)
            order.discard(name)
        text = chance.choice(["", "a", "a1", "1", "/", "é", "x", "none", "\0"])
        assert order.beginning(text) == sorted(each for each in names if each.startswith(text))
        assert order.containing(text) == sorted(each for each in names if text in each)
    assert len(order) == len(names)
    assert order.all() == sorted(names)


def test_no_names() -> None:
    order = NameOrder([])
    assert order.beginning("a") == order.containing("a") == order.containing("") == order.all() == []
