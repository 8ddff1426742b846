"""Dialects: what `extends` merges, how items are renamed, removed, replaced and placed."""

from __future__ import annotations

import os
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protogen.compiler import compile_file
from protogen.problems import Problems, SourceMap, Span
from protogen.schema.dialects.extends import Merged, merge_bases
from protogen.schema.dialects.merge import merge
from protogen.schema.dialects.project_folder import project_folder
from protogen.schema.dialects.renames import apply_renames
from protogen.schema.text.document import parse_document, read_document
from protogen.schema.text.nodes import MappingNode, Node, ScalarNode, SequenceNode, to_data


def test_a_base_that_is_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "dialect.yaml").write_text("protocol: two\nextends: pipe.yaml\n")
    (problem,) = compile_file(tmp_path / "dialect.yaml").problems
    assert problem.message == "the base can't be read: it is a pipe"


def tree(text: str, file: str) -> Node:
    problems = Problems()
    document = parse_document(dedent(text), file, problems)
    assert list(problems) == []
    assert document is not None
    return document.root


def over(base: str, dialect: str) -> tuple[Node, list[tuple[str, str, str]]]:
    """Return the merged tree, and place, code and message of each problem."""
    problems = Problems()
    stated = tree(dialect, "dialect")
    merged = merge(apply_renames(tree(base, "base"), stated, problems), stated, problems)
    found = [(str(problem.span), problem.code, problem.message) for problem in problems]
    return merged, found


def merged(base: str, dialect: str) -> object:
    root, found = over(base, dialect)
    assert found == []
    return to_data(root)


def problems_of(base: str, dialect: str) -> list[tuple[str, str, str]]:
    return over(base, dialect)[1]


def order(base: str, dialect: str) -> list[object]:
    root, found = over(base, dialect)
    assert found == []
    items = root.child("fields")
    assert isinstance(items, MappingNode)
    return [key.value for key, _ in items.items]


class TestMerging:
    BASE = """
        protocol: rn1
        link: {baud: 115200, parity: none}
        frame:
          start: {literal: [1, 2]}
        """

    def test_a_mapping_merges_by_key_and_anything_else_is_replaced(self) -> None:
        dialect = """
            protocol: rn1_firmware
            link: {parity: even, stop_bits: 2}
            frame:
              start: {literal: [3]}
            """
        assert merged(self.BASE, dialect) == {
            "protocol": "rn1_firmware",
            "link": {"baud": 115200, "parity": "even", "stop_bits": 2},
            "frame": {"start": {"literal": [3]}},
        }

    def test_a_scalar_takes_the_place_of_a_mapping_and_the_other_way_round(self) -> None:
        assert merged("{a: {b: 1}, c: 2}", "{a: 1, c: {d: 2}}") == {"a": 1, "c": {"d": 2}}

    def test_an_empty_dialect_changes_nothing(self) -> None:
        assert merged(self.BASE, "{}") == to_data(tree(self.BASE, "base"))

    def test_items_keep_their_position_and_new_ones_come_last(self) -> None:
        assert order("fields: {a: 1, b: 2}", "fields: {c: 3, a: 4}") == ["a", "b", "c"]

    def test_what_replaces_a_tree_that_is_no_mapping(self) -> None:
        assert merged("[1, 2]", "{a: 1}") == {"a": 1}

    def test_nodes_keep_the_file_that_they_come_from(self) -> None:
        root, _ = over("{a: {b: 1, c: 2}, d: 3}", "{a: {b: 4}}")
        places = {path: root.at(path) for path in (("a", "b"), ("a", "c"), ("d",), ("a",), ())}
        files = {path: node.span.file for path, node in places.items() if node is not None}
        assert files == {
            ("a", "b"): "dialect",
            ("a", "c"): "base",
            ("d",): "base",
            ("a",): "dialect",
            (): "dialect",
        }


class TestRemoving:
    def test_names_are_taken_away(self) -> None:
        base = "messages: {a: 1, b: 2, c: 3}"
        assert merged(base, "messages: {remove: [a, c]}") == {"messages": {"b": 2}}

    def test_what_was_removed_can_be_stated_anew(self) -> None:
        base = "messages: {a: {x: 1}, b: 2}"
        dialect = "messages: {remove: [a], a: {y: 1}}"
        assert merged(base, dialect) == {"messages": {"b": 2, "a": {"y": 1}}}

    def test_numbers_name_numbers(self) -> None:
        base = "substitute: {0x1B: 1, 0x7C: 2}"
        assert merged(base, "substitute: {remove: [27]}") == {"substitute": {0x7C: 2}}

    def test_nothing_by_that_name(self) -> None:
        problems = Problems()
        base, dialect = tree("{gyro: 1}", "base"), tree("remove: [gryo, sonar]", "dialect")
        merge(base, dialect, problems)
        first, second = problems
        assert (str(first.span), first.code) == ("dialect:1:10", "PG023")
        assert first.message == "there is no `gryo` to remove here"
        assert first.hint == "did you mean `gyro`?"
        assert (str(second.span), second.hint) == ("dialect:1:16", None)


class TestReplacing:
    def test_the_mapping_of_the_base_is_discarded(self) -> None:
        base = "fields: {a: 1, b: {c: 2}}"
        assert merged(base, "fields: {replace: true, d: 3}") == {"fields": {"d": 3}}

    def test_the_item_keeps_its_position(self) -> None:
        base = "fields: {a: {x: 1}, b: 2}"
        assert order(base, "fields: {a: {replace: true, y: 1}}") == ["a", "b"]

    def test_the_item_can_be_moved_at_the_same_time(self) -> None:
        base = "fields: {a: {x: 1}, b: 2}"
        dialect = "fields: {a: {replace: true, y: 1, after: b}}"
        assert merged(base, dialect) == {"fields": {"b": 2, "a": {"y": 1}}}
        assert order(base, dialect) == ["b", "a"]

    @pytest.mark.parametrize("other", ["remove: [a]", "rename: {a: b}"])
    def test_there_is_nothing_to_rename_or_remove_then(self, other: str) -> None:
        found = problems_of("f: {a: 1}", f"f: {{replace: true, {other}}}")
        message = "with `replace: true` there is nothing left to rename or remove"
        assert ("PG025", message) in [(code, message) for _, code, message in found]

    def test_inside_of_it_there_is_nothing_either(self) -> None:
        dialect = "f: {replace: true, a: {rename: {b: c}, remove: [d]}}"
        found = problems_of("f: {a: {b: 1, d: 2}}", dialect)
        assert [(place, code) for place, code, _ in found] == [
            ("dialect:1:33", "PG023"),
            ("dialect:1:49", "PG023"),
        ]


class TestPlacing:
    BASE = "fields: {a: {}, b: {}, c: {}}"

    @pytest.mark.parametrize(
        ("items", "expected"),
        [
            ("x: {after: a}", "a x b c"),
            ("x: {before: a}", "x a b c"),
            ("x: {after: c}", "a b c x"),
            ("x: {after: a}, y: {after: a}", "a x y b c"),
            ("x: {before: c}, y: {before: c}", "a b x y c"),
            ("x: {after: a}, y: {after: x}, z: {after: a}", "a x y z b c"),
            ("y: {after: x}, x: {after: b}", "a b x y c"),
            ("x: {after: y}, y: {}", "a b c y x"),
            ("c: {before: a}", "c a b"),
            ("a: {after: c}, x: {after: a}", "b c a x"),
            ("x: {before: b}, y: {after: b}", "a x b y c"),
        ],
    )
    def test_items_stand_beside_their_neighbour(self, items: str, expected: str) -> None:
        assert order(self.BASE, f"fields: {{{items}}}") == expected.split()

    def test_a_place_is_no_part_of_the_item(self) -> None:
        dialect = "fields: {x: {type: bool, after: a}, b: {doc: moved, before: a}}"
        assert merged(self.BASE, dialect) == {
            "fields": {"b": {"doc": "moved"}, "a": {}, "x": {"type": "bool"}, "c": {}}
        }

    def test_a_thousand_items_in_a_chain(self) -> None:
        names = ["a", *(f"x{number}" for number in range(2000))]
        chain = zip(names[1:], names, strict=False)
        items = ", ".join(f"{name}: {{after: {neighbour}}}" for name, neighbour in chain)
        assert order(self.BASE, f"fields: {{{items}}}") == [*names, "b", "c"]

    def test_an_unknown_neighbour(self) -> None:
        dialect = "fields:\n  x: {after: d}\n"
        (problem,) = problems_of(self.BASE, dialect)
        assert problem == ("dialect:2:14", "PG024", "there is no `d` to stand after")

    def test_a_neighbour_that_was_removed(self) -> None:
        ((_, code, _),) = problems_of(self.BASE, "fields: {remove: [a], x: {after: a}}")
        assert code == "PG024"

    def test_circles(self) -> None:
        found = problems_of(self.BASE, "fields: {x: {after: y}, y: {before: x}, z: {after: z}}")
        assert [(code, message) for _, code, message in found] == [
            ("PG025", "`x` is placed beside itself"),
            ("PG025", "`y` is placed beside itself"),
            ("PG025", "`z` is placed beside itself"),
        ]

    def test_one_place_is_enough(self) -> None:
        ((place, code, _),) = problems_of(self.BASE, "fields: {x: {after: a, before: b}}")
        assert (place, code) == ("dialect:1:32", "PG025")


class TestWhatIsNoDirective:
    """Items may be called like directives: they are mappings, or numbers."""

    @pytest.mark.parametrize("name", ["rename", "remove", "replace", "after", "before"])
    def test_an_item_that_is_a_mapping_or_a_number(self, name: str) -> None:
        assert merged("fields: {a: {}}", f"fields: {{{name}: {{type: [x]}}, a: {{}}}}") == {
            "fields": {"a": {}, name: {"type": ["x"]}}
        }
        assert merged("values: {a: 1}", f"values: {{{name}: 3}}") == {"values": {"a": 1, name: 3}}

    def test_new_items_can_be_placed_among_each_other(self) -> None:
        dialect = "fields: {a: {}, b: {}, c: {before: b}}"
        assert order("{}", dialect) == ["a", "c", "b"]

    def test_in_a_new_mapping_there_is_nothing_to_rename_or_remove(self) -> None:
        found = problems_of("{}", "new: {rename: {a: b}, remove: [c]}")
        assert [(place, code) for place, code, _ in found] == [
            ("dialect:1:16", "PG023"),
            ("dialect:1:32", "PG023"),
        ]

    @pytest.mark.parametrize(
        "directive",
        [
            "rename: a",
            "rename: [a]",
            "remove: a",
            "remove: [[a]]",
            "replace: false",
            "replace: yes",
        ],
    )
    def test_the_wrong_shape(self, directive: str) -> None:
        ((place, code, message),) = problems_of("f: {a: 1}", f"f: {{{directive}}}")
        assert (place, code) == ("dialect:1:5", "PG025")
        assert message.startswith(f"`{directive.split(':', maxsplit=1)[0]}` takes ")


class TestRenaming:
    def test_an_item_keeps_its_position_and_content(self) -> None:
        base = "fields: {a: {x: 1}, b: 2}"
        dialect = "fields: {rename: {a: c}}"
        assert merged(base, dialect) == {"fields": {"c": {"x": 1}, "b": 2}}
        assert order(base, dialect) == ["c", "b"]

    def test_the_dialect_uses_the_new_name(self) -> None:
        base = "messages: {a: {id: 1, fields: {x: 1}}}"
        dialect = "messages: {rename: {a: b}, b: {fields: {rename: {x: y}, y: 2}}}"
        assert merged(base, dialect) == {"messages": {"b": {"id": 1, "fields": {"y": 2}}}}

    def test_names_can_be_exchanged(self) -> None:
        base = "fields: {a: 1, b: 2}"
        assert merged(base, "fields: {rename: {a: b, b: a}}") == {"fields": {"b": 1, "a": 2}}

    def test_a_key_has_the_place_of_its_new_name(self) -> None:
        root, _ = over("fields: {a: 1}", "fields: {rename: {a: c}}")
        fields = root.child("fields")
        assert isinstance(fields, MappingNode)
        assert fields.items[0][0].span == Span.at("dialect", 1, 22)

    def test_nothing_by_that_name(self) -> None:
        (problem,) = problems_of("f: {gyro: 1}", "f: {rename: {gryo: x}}")
        assert problem == ("dialect:1:14", "PG023", "there is no `gryo` to rename here")

    @pytest.mark.parametrize("renames", ["a: b", "a: x, b: x"])
    def test_a_name_that_is_taken(self, renames: str) -> None:
        ((_, code, message),) = problems_of("f: {a: 1, b: 2}", f"f: {{rename: {{{renames}}}}}")
        assert (code, message) == ("PG025", f"there is a `{renames[-1]}` already")


class TestReferencesToFields:
    BASE = """
        messages:
          report:
            fields:
              number: uint8
              kind: {type: uint8}
              names: {type: uint8, count: number}
              text: {type: ascii, size: number}
              rest: {type: uint8, count: {fill: true, max: 3}}
              value:
                switch: kind
                cases:
                  1: {fields: {a: {type: bytes, size: number}, b: uint8}}
                  2: {fields: {number: uint8, c: {type: bytes, size: number}}}
                  3: {type: uint8, count: number}
              inner: {fields: {d: {type: bytes, size: number}}}
            examples:
              one: {frame: {hex: 00}, values: {number: 1, kind: 2, text: number}}
              two:
                values: {kind: 1}
                contradicts: {fails: values, why: x, reads: {number: 2}}
          other:
            fields: {number: uint8, text: {type: ascii, size: number}}
        """

    def renamed(self) -> Node:
        dialect = "messages: {report: {fields: {rename: {number: clusters, kind: tag}}}}"
        root, found = over(self.BASE, dialect)
        assert found == []
        return root

    @pytest.mark.parametrize(
        ("path", "value"),
        [
            ("names count", "clusters"),
            ("text size", "clusters"),
            ("value switch", "tag"),
            ("value cases 1 fields a size", "clusters"),
            # The case has a field of its own by that name.
            ("value cases 2 fields c size", "number"),
            ("value cases 3 count", "clusters"),
            ("inner fields d size", "clusters"),
        ],
    )
    def test_of_the_fields_beside_it_and_inside(self, path: str, value: str) -> None:
        steps = [int(step) if step.isdigit() else step for step in path.split()]
        node = self.renamed().at(("messages", "report", "fields", *steps))
        assert isinstance(node, ScalarNode)
        assert node.value == value

    def test_of_examples(self) -> None:
        examples = self.renamed().at(("messages", "report", "examples"))
        assert examples is not None
        assert to_data(examples) == {
            "one": {"frame": {"hex": 0}, "values": {"clusters": 1, "tag": 2, "text": "number"}},
            "two": {
                "values": {"tag": 1},
                "contradicts": {"fails": "values", "why": "x", "reads": {"clusters": 2}},
            },
        }

    def test_of_other_messages_stay(self) -> None:
        path = ("messages", "other")
        assert self.renamed().at(path) == tree(self.BASE, "base").at(path)

    def test_a_reference_has_the_place_where_it_is_written(self) -> None:
        node = self.renamed().at(("messages", "report", "fields", "names", "count"))
        assert node is not None
        assert str(node.span) == "base:7:35"

    def test_inside_of_a_case_only_its_own_fields_refer_to_it(self) -> None:
        dialect = "messages: {report: {fields: {value: {cases: {1: {fields: {rename: {b: x}}}}}}}}"
        root, found = over(self.BASE, dialect)
        assert found == []
        fields = root.at(("messages", "report", "fields", "value", "cases", 1, "fields"))
        assert isinstance(fields, MappingNode)
        assert [key.value for key, _ in fields.items] == ["a", "x"]

    STRUCTS = """
        types:
          point: {fields: {x: uint8, y: {type: bytes, size: x}}}
        messages:
          line:
            fields: {start: point, stops: {type: point, count: 2}, x: uint8}
            examples:
              - values: {start: {x: 1, y: 2}, stops: [{x: 3}, {y: 4}], x: 5}
          raw: {fields: unspecified}
        """

    def test_of_a_type_in_the_values_of_the_messages_that_use_it(self) -> None:
        root, found = over(self.STRUCTS, "types: {point: {fields: {rename: {x: east}}}}")
        assert found == []
        data = to_data(root)
        assert data["types"]["point"] == {
            "fields": {"east": "uint8", "y": {"type": "bytes", "size": "east"}}
        }
        assert data["messages"]["line"]["examples"] == [
            {"values": {"start": {"east": 1, "y": 2}, "stops": [{"east": 3}, {"y": 4}], "x": 5}}
        ]

    def test_of_a_struct_that_is_written_in_place(self) -> None:
        base = """
            messages:
              line:
                fields: {start: {fields: {x: uint8}}, x: uint8}
                examples: {one: {values: {start: {x: 1}, x: 2}}}
            """
        root, _ = over(base, "messages: {line: {fields: {start: {fields: {rename: {x: e}}}}}}")
        values = root.at(("messages", "line", "examples", "one", "values"))
        assert values is not None
        assert to_data(values) == {"start": {"e": 1}, "x": 2}


class TestReferencesToParts:
    SHARED = """
        endpoints: {pc: PC, esp: ESP}
        frame:
          sync: {literal: 0x55}
          length: {type: uint8, counts: [counter, payload]}
          counter: {type: uint8, counter: true}
          payload: {}
          crc: {type: uint8, covers: length..counter, when: payload}
          end: {literal: 1, when: counter}
        transparency: {covers: counter..crc, escape: {byte: 1, of: [1]}}
        content_covers: [counter, payload]
        messages:
          ack:
            from: esp
            id: {counter: 3, length: 1}
            examples:
              one: {content: {hex: 00}, covers: counter, parts: {counter: 7}}
        reserved: {identities: [{from: esp, id: {counter: 9}}]}
        """

    def test_of_a_frame_for_all(self) -> None:
        data = merged(self.SHARED, "frame: {rename: {counter: number}}")
        assert data == to_data(tree(self.SHARED.replace("counter", "number"), "x")) | {
            # `counter: true` is no name of a part.
            "frame": {
                "sync": {"literal": 0x55},
                "length": {"type": "uint8", "counts": ["number", "payload"]},
                "number": {"type": "uint8", "counter": True},
                "payload": {},
                "crc": {"type": "uint8", "covers": "length..number", "when": "payload"},
                "end": {"literal": 1, "when": "number"},
            }
        }

    def test_other_forms_than_mappings_and_names_stay_as_they_are(self) -> None:
        base = """
            frame: {sync: {literal: 1}, id: {id: true, covers: 7, counts: [sync, 8]}}
            transparency: slip
            messages: {ack: {id: 3, examples: none}, raw: none}
            """
        assert merged(base, "frame: {rename: {sync: start}}") == {
            "frame": {
                "start": {"literal": 1},
                "id": {"id": True, "covers": 7, "counts": ["start", 8]},
            },
            "transparency": "slip",
            "messages": {"ack": {"id": 3, "examples": "none"}, "raw": "none"},
        }

    SPLIT = """
        endpoints: {host: Host, robot: Robot}
        frame:
          host: {id: {type: char, id: true}, sum: {covers: id}}
          robot: {id: {type: char, id: true}, sum: {covers: id}}
        transparency: {covers: id}
        content_covers: id
        messages:
          go: {from: host, id: {id: 1}, examples: [{parts: {id: 1}}]}
          ok: {from: [robot], id: {id: 2}}
          hi: {from: [host, robot], id: {id: 3}}
          no: {id: {id: 4}}
        """

    def test_of_the_frame_of_one_sender(self) -> None:
        data = merged(self.SPLIT, "frame: {host: {rename: {id: code}}}")
        assert isinstance(data, dict)
        assert data["frame"]["host"]["sum"] == {"covers": "code"}
        assert data["frame"]["robot"]["sum"] == {"covers": "id"}
        assert data["messages"]["go"] == {
            "from": "host",
            "id": {"code": 1},
            "examples": [{"parts": {"code": 1}}],
        }
        assert data["messages"]["ok"]["id"] == {"id": 2}

    def test_what_serves_both_senders_waits_for_the_other(self) -> None:
        one = merged(self.SPLIT, "frame: {host: {rename: {id: code}}}")
        assert isinstance(one, dict)
        assert (one["transparency"], one["content_covers"]) == ({"covers": "id"}, "id")
        assert [one["messages"][name]["id"] for name in ("hi", "no")] == [{"id": 3}, {"id": 4}]
        dialect = "frame: {host: {rename: {id: code}}, robot: {rename: {id: code}}}"
        both = merged(self.SPLIT, dialect)
        assert isinstance(both, dict)
        assert (both["transparency"], both["content_covers"]) == ({"covers": "code"}, "code")
        assert [both["messages"][name]["id"] for name in ("hi", "no")] == [{"code": 3}, {"code": 4}]

    @pytest.mark.parametrize(
        ("dialect", "host", "robot"),
        [
            ("frame: {host: {rename: {id: code}}}", "code..sum", "id..sum"),
            ("frame: {robot: {rename: {sum: crc}}}", "id..sum", "id..crc"),
        ],
    )
    def test_of_a_transparency_for_each_sender(self, dialect: str, host: str, robot: str) -> None:
        split = "transparency: {host: {covers: id..sum}, robot: {covers: id..sum}}"
        base = self.SPLIT.replace("transparency: {covers: id}", split)
        data = merged(base, dialect)
        assert isinstance(data, dict)
        regions = data["transparency"]
        assert (regions["host"]["covers"], regions["robot"]["covers"]) == (host, robot)

    def test_a_sender_is_no_part(self) -> None:
        base = "{endpoints: {a: A, b: B}, frame: {a: {x: {covers: a}}}}"
        data = merged(base, "{endpoints: {rename: {a: c}}}")
        assert data == {"endpoints": {"c": "A", "b": "B"}, "frame": {"c": {"x": {"covers": "a"}}}}


class TestReferencesToMessagesAndTypes:
    def test_of_a_message(self) -> None:
        base = """
            messages: {ok: {id: 1}, other: {id: 1}}
            overloads: {o: {messages: [ok, other], by: undecidable, yields: ok}}
            exchanges:
              start: {steps: [ok, {message: ok, doc: ok}, other]}
            reserved: {fields: {ok: [ok]}}
            """
        assert merged(base, "messages: {rename: {ok: done}}") == {
            "messages": {"done": {"id": 1}, "other": {"id": 1}},
            "overloads": {
                "o": {"messages": ["done", "other"], "by": "undecidable", "yields": "done"}
            },
            "exchanges": {"start": {"steps": ["done", {"message": "done", "doc": "ok"}, "other"]}},
            "reserved": {"fields": {"done": ["ok"]}},
        }

    def test_of_a_type(self) -> None:
        base = """
            types:
              unit: {type: uint8, values: {unit: 1}}
              pair: {fields: {a: unit, b: {type: unit, doc: unit}}}
              alias: unit
            frame: {type: {type: unit}, id: {type: uint8, id: true}}
            messages:
              unit:
                fields:
                  unit: unit
                  type: {type: unit}
                  either: {switch: unit, cases: {1: unit, 2: {fields: {x: unit}}}}
                examples: {one: {values: {type: unit}}}
            """
        assert merged(base, "types: {rename: {unit: metre}}") == {
            "types": {
                "metre": {"type": "uint8", "values": {"unit": 1}},
                "pair": {"fields": {"a": "metre", "b": {"type": "metre", "doc": "unit"}}},
                "alias": "metre",
            },
            "frame": {"type": {"type": "metre"}, "id": {"type": "uint8", "id": True}},
            "messages": {
                "unit": {
                    "fields": {
                        "unit": "metre",
                        "type": {"type": "metre"},
                        "either": {
                            "switch": "unit",
                            "cases": {1: "metre", 2: {"fields": {"x": "metre"}}},
                        },
                    },
                    "examples": {"one": {"values": {"type": "unit"}}},
                }
            },
        }

    def test_of_a_type_in_the_frame_of_a_sender(self) -> None:
        base = "{endpoints: {a: A}, frame: {a: {x: {type: t}}}, types: {t: uint8}}"
        data = merged(base, "types: {rename: {t: u}}")
        assert isinstance(data, dict)
        assert data["frame"] == {"a": {"x": {"type": "u"}}}

    def test_items_of_other_kinds_are_renamed_alone(self) -> None:
        base = "{decisions: {a: 1}, x: a}"
        assert merged(base, "decisions: {rename: {a: b}}") == {"decisions": {"b": 1}, "x": "a"}


class Project:
    """A folder with schemas in it."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.sources = SourceMap()
        (root / "protogen.toml").touch()

    def write(self, name: str, text: str) -> Path:
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def load(self, name: str) -> tuple[Merged | None, list[tuple[str, str, str]]]:
        problems = Problems()
        document = read_document(self.root / name, problems, self.sources)
        result = None if document is None else merge_bases(document, problems, self.sources)
        found = [
            (str(problem.span).removeprefix(f"{self.root}/"), problem.code, problem.message)
            for problem in problems
        ]
        return result, found


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path.resolve())


class TestFiles:
    def test_a_schema_without_a_base_is_its_own_tree(self, project: Project) -> None:
        project.write("a.yaml", "protocol: a\n")
        result, found = project.load("a.yaml")
        assert found == []
        assert result is not None
        assert to_data(result.root) == {"protocol": "a"}
        assert result.files == (f"{project.root}/a.yaml",)

    def test_a_chain_in_several_folders(self, project: Project) -> None:
        project.write("a.yaml", "{protocol: a, link: {baud: 1, parity: odd}}\n")
        project.write("dialects/b.yaml", "{protocol: b, extends: ../a.yaml, link: {baud: 2}}\n")
        project.write("dialects/c.yaml", "{extends: b.yaml, link: {rename: {baud: rate}}}\n")
        result, found = project.load("dialects/c.yaml")
        assert found == []
        assert result is not None
        assert to_data(result.root) == {"protocol": "b", "link": {"rate": 2, "parity": "odd"}}
        names = [Path(file).relative_to(project.root).as_posix() for file in result.files]
        assert names == ["dialects/c.yaml", "dialects/b.yaml", "a.yaml"]
        assert str(result.find(("link", "rate"))) == f"{project.root}/dialects/b.yaml:1:48"
        assert str(result.find(("link", "parity"))) == f"{project.root}/a.yaml:1:39"
        assert result.find(("protocol",), key=True).column == 2
        assert project.sources.line(f"{project.root}/a.yaml", 1) is not None

    @pytest.mark.parametrize("chain", [["a"], ["a", "b"], ["a", "b", "c"]])
    def test_circles(self, project: Project, chain: list[str]) -> None:
        for name, base in zip(chain, [*chain[1:], "a"], strict=True):
            project.write(f"{name}.yaml", f"extends: ./{base}.yaml\n")
        result, ((place, code, message),) = project.load("a.yaml")
        assert result is None
        assert (place, code) == (f"{chain[-1]}.yaml:1:10", "PG020")
        assert message.count(".yaml") == len(chain)

    def test_a_circle_through_a_symbolic_link(self, project: Project) -> None:
        path = project.write("a.yaml", "extends: b.yaml\n")
        (project.root / "b.yaml").symlink_to(path)
        _, ((_, code, _),) = project.load("a.yaml")
        assert code == "PG020"

    @pytest.mark.parametrize("base", ["../x.yaml", "s/../../x.yaml", "/etc/hostname"])
    def test_out_of_the_project(self, project: Project, base: str) -> None:
        project.write("a.yaml", f"extends: {base}\n")
        result, found = project.load("a.yaml")
        assert result is None
        assert found == [("a.yaml:1:10", "PG021", "the base is outside of the project")]

    def test_out_of_the_project_by_a_symbolic_link(self, project: Project) -> None:
        inner = (
            Project(project.root / "inner") if (project.root / "inner").mkdir() is None else None
        )
        assert inner is not None
        target = project.write("x.yaml", "protocol: x\n")
        (inner.root / "link.yaml").symlink_to(target)
        inner.write("a.yaml", "extends: link.yaml\n")
        _, ((_, code, _),) = inner.load("a.yaml")
        assert code == "PG021"

    def test_bases_of_bases_stay_in_the_project_of_the_schema(self, project: Project) -> None:
        (project.root / "inner").mkdir()
        (project.root / "inner" / ".git").mkdir()
        project.write("inner/a.yaml", "extends: ../b.yaml\n")
        project.write("b.yaml", "extends: inner/c.yaml\n")
        project.write("inner/c.yaml", "protocol: c\n")
        assert project.load("inner/a.yaml")[1][0][1] == "PG021"
        assert project.load("b.yaml")[1] == []

    @pytest.mark.parametrize(
        ("base", "reason"),
        [
            ("none.yaml", "No such file or directory"),
            (".", "Is a directory"),
            ('"a\\0b"', "embedded null byte"),
            ("x" * 300, "File name too long"),
        ],
    )
    def test_a_base_that_cant_be_read(self, project: Project, base: str, reason: str) -> None:
        project.write("a.yaml", f"extends: {base}\n")
        result, found = project.load("a.yaml")
        assert result is None
        assert found == [("a.yaml:1:10", "PG022", f"the base can't be read: {reason}")]

    def test_a_base_that_is_no_mapping(self, project: Project) -> None:
        project.write("a.yaml", "extends: b.yaml\n")
        project.write("b.yaml", "- x\n")
        _, ((place, code, _),) = project.load("a.yaml")
        assert (place, code) == ("a.yaml:1:10", "PG022")

    def test_problems_of_a_base_are_reported_in_its_file(self, project: Project) -> None:
        project.write("a.yaml", "{extends: b.yaml, remove: [y]}\n")
        project.write("b.yaml", "x: 1\nx: 2\n")
        result, found = project.load("a.yaml")
        assert [(place, code) for place, code, _ in found] == [
            ("a.yaml:1:28", "PG023"),
            ("b.yaml:2:1", "PG006"),
        ]
        assert result is not None
        project.write("b.yaml", "x: [\n")
        result, ((place, code, _),) = project.load("a.yaml")
        assert result is None
        assert (place.split(":")[0], code) == ("b.yaml", "PG004")

    @pytest.mark.parametrize("value", ["[b.yaml]", "{a: b}", "1", "true", "''", ""])
    def test_extends_takes_a_path(self, project: Project, value: str) -> None:
        project.write("a.yaml", f"protocol: a\nextends: {value}\n")
        result, ((place, code, _),) = project.load("a.yaml")
        assert (place.split(":")[1], code) == ("2", "PG025")
        # Without its base, most of the schema would seem to be missing.
        assert result is None

    def test_a_document_that_is_no_mapping_extends_nothing(self, project: Project) -> None:
        project.write("a.yaml", "[extends]\n")
        result, found = project.load("a.yaml")
        assert found == []
        assert result is not None


class TestProjectFolder:
    @pytest.mark.parametrize("mark", [".git", "pyproject.toml", "protogen.toml"])
    def test_is_the_nearest_that_is_marked(self, tmp_path: Path, mark: str) -> None:
        inner = tmp_path / "project" / "a" / "b"
        inner.mkdir(parents=True)
        (tmp_path / "project" / mark).touch()
        (tmp_path / ".git").touch()
        assert project_folder(str(inner / "x.yaml")) == (tmp_path / "project").resolve()

    def test_is_the_current_folder_if_the_file_is_inside(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (tmp_path / "a").mkdir()
        monkeypatch.chdir(tmp_path)
        assert project_folder("a/x.yaml") == tmp_path.resolve()
        assert project_folder(str(tmp_path / "a" / "x.yaml")) == tmp_path.resolve()

    def test_is_the_folder_of_the_file_otherwise(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (tmp_path / "a").mkdir()
        (tmp_path / "b").mkdir()
        monkeypatch.chdir(tmp_path / "a")
        assert project_folder("../b/x.yaml") == (tmp_path / "b").resolve()


NAMES = st.sampled_from(["a", "b", "c", "fields", "type", "messages", "frame", "types"])
TREES = st.recursive(
    st.integers(0, 9) | NAMES,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=4),
    max_leaves=15,
)
MAPPINGS = st.dictionaries(NAMES, TREES, max_size=5)
DIRECTIVES = st.dictionaries(
    st.sampled_from(["rename", "remove", "replace", "after", "before"]) | NAMES,
    TREES | st.just(True) | st.lists(NAMES, max_size=2) | st.dictionaries(NAMES, NAMES, max_size=2),
    max_size=4,
)
DIALECTS = st.dictionaries(NAMES, TREES | DIRECTIVES, max_size=4) | DIRECTIVES
SPAN = Span.at("f", 1, 1)


def node_of(data: object) -> Node:
    if isinstance(data, dict):
        items = ((ScalarNode(key, str(key), True, SPAN), node_of(data[key])) for key in data)
        return MappingNode(tuple(items), SPAN)
    if isinstance(data, list):
        return SequenceNode(tuple(node_of(item) for item in data), SPAN)
    assert isinstance(data, str | int)
    return ScalarNode(data, str(data), True, SPAN)


def plain_merge(base: object, dialect: object) -> object:
    if not (isinstance(base, dict) and isinstance(dialect, dict)):
        return dialect
    both = {key: plain_merge(base[key], dialect[key]) for key in base if key in dialect}
    return base | dialect | both


class TestProperties:
    @given(MAPPINGS, MAPPINGS)
    def test_without_directives_it_is_the_union_of_both(
        self, base: object, dialect: object
    ) -> None:
        problems = Problems()
        result = merge(node_of(base), node_of(dialect), problems)
        assert list(problems) == []
        assert to_data(result) == plain_merge(base, dialect)

    @given(MAPPINGS, DIALECTS)
    def test_any_dialect_gives_a_tree_and_problems(self, base: object, dialect: object) -> None:
        problems = Problems()
        stated = node_of(dialect)
        to_data(merge(apply_renames(node_of(base), stated, problems), stated, problems))

    @given(st.permutations(["a", "b", "c", "d"]), st.data())
    def test_every_item_is_there_once_wherever_it_is_placed(
        self, names: list[str], data: st.DataObject
    ) -> None:
        items: dict[str, object] = {}
        for position, name in enumerate(["x", "y", "z"]):
            # Neighbours that were written before leave no circles.
            neighbour = data.draw(st.sampled_from([*names, *("x", "y", "z")[:position]]))
            items[name] = {data.draw(st.sampled_from(["after", "before"])): neighbour}
        problems = Problems()
        base = {name: {} for name in names}
        result = merge(node_of(base), node_of(items), problems)
        assert list(problems) == []
        assert isinstance(result, MappingNode)
        placed = [key.text for key, _ in result.items]
        assert sorted(placed) == ["a", "b", "c", "d", "x", "y", "z"]
        assert [name for name in placed if name in names] == names
        for name, place in items.items():
            assert isinstance(place, dict)
            ((where, neighbour),) = place.items()
            ahead = placed.index(neighbour) < placed.index(name)
            assert ahead == (where == "after")


class TestReferencesToEndpointsAndDecisions:
    BASE = """
        endpoints: {a: A, b: B}
        byte_order: {a: little, b: big}
        frame: {a: {x: {literal: 1, unprotected: why}}, b: {y: {literal: 2}}}
        transparency: {a: slip}
        messages:
          one: {from: a, examples: {e: {sender: a}, f: {sender: b}}}
          two: {from: [a, b]}
        overloads: {o: {messages: [one, two], decision: why}}
        exchanges: {x: {steps: [one, {message: one, example: e}, {message: two, example: e}]}}
        decisions: {why: {question: why}}
        reserved: {identities: [{from: a, id: 1}]}
        """

    def test_of_an_endpoint(self) -> None:
        data = merged(self.BASE, "endpoints: {rename: {a: left}}")
        assert isinstance(data, dict)
        for key in ("endpoints", "byte_order", "frame"):
            assert list(data[key]) == ["left", "b"]
        assert data["transparency"] == {"left": "slip"}
        one, two = data["messages"].values()
        assert one == {"from": "left", "examples": {"e": {"sender": "left"}, "f": {"sender": "b"}}}
        assert two == {"from": ["left", "b"]}
        assert data["reserved"] == {"identities": [{"from": "left", "id": 1}]}

    def test_a_dialect_says_the_new_name_wherever_it_stands(self) -> None:
        dialect = """
            frame: {left: {rename: {x: start}, start: {literal: 3}}}
            endpoints: {rename: {a: left}}
            """
        data = merged(self.BASE, dialect)
        assert isinstance(data, dict)
        assert data["frame"]["left"] == {"start": {"literal": 3, "unprotected": "why"}}

    def test_of_a_part_called_like_an_endpoint(self) -> None:
        base = "{endpoints: {a: A}, frame: {a: {literal: 1}, payload: {}}}"
        data = merged(base, "endpoints: {rename: {a: left}}")
        assert isinstance(data, dict)
        assert list(data["frame"]) == ["a", "payload"]

    def test_of_a_decision(self) -> None:
        data = merged(self.BASE, "decisions: {rename: {why: because}}")
        assert isinstance(data, dict)
        assert data["frame"]["a"]["x"]["unprotected"] == "because"
        assert data["overloads"]["o"]["decision"] == "because"
        assert data["decisions"] == {"because": {"question": "why"}}

    def test_of_an_example(self) -> None:
        data = merged(self.BASE, "messages: {one: {examples: {rename: {e: first}}}}")
        assert isinstance(data, dict)
        assert data["exchanges"]["x"]["steps"] == [
            "one",
            {"message": "one", "example": "first"},
            {"message": "two", "example": "e"},
        ]


class TestReferencesToValues:
    BASE = """
        types:
          state: {type: uint8, values: {on: 1, off: 0}, default: on}
          alias: state
          pair: {fields: {left: state, right: alias}}
        messages:
          m:
            fields:
              k: {type: uint8, values: {one: 1, two: 2}, default: one}
              s: {type: state, const: on}
              p: {type: pair, count: 2}
              f: {type: uint8, flags: {one: 0, hot: 1}}
              b: {type: uint8, bits: {low: {bits: 0..1, values: {one: 1}}, one: 2}}
              v: {switch: k, cases: {one: uint8, two: {fields: {w: {switch: k, cases: {one: x}}}}}}
              u: {switch: s, cases: {on: uint8}}
            examples:
              e:
                values: {k: one, s: on, p: [{left: on, right: off}, {left: 1}], f: [one, hot],
                  b: {low: one, one: 1}}
                contradicts: {reads: {k: one, f: {one: 1}}}
        reserved: {values: {m.k: [3], state: [4]}}
        """

    def renamed(self, path: str, names: str) -> Any:
        *outer, last = path.split()
        dialect = f"{last}: {{rename: {names}}}"
        for step in reversed(outer):
            dialect = f"{step}: {{{dialect}}}"
        return merged(self.BASE, "{" + dialect + "}")

    def test_of_an_enum(self) -> None:
        message = self.renamed("messages m fields k values", "{one: uno}")["messages"]["m"]
        fields, example = message["fields"], message["examples"]["e"]
        assert fields["k"] == {"type": "uint8", "values": {"uno": 1, "two": 2}, "default": "uno"}
        assert list(fields["v"]["cases"]) == ["uno", "two"]
        assert fields["v"]["cases"]["two"]["fields"]["w"]["cases"] == {"uno": "x"}
        assert example["values"]["k"] == "uno"
        assert example["contradicts"]["reads"] == {"k": "uno", "f": {"one": 1}}
        assert (example["values"]["f"], list(fields["f"]["flags"])) == (
            ["one", "hot"],
            ["one", "hot"],
        )

    def test_of_a_declared_enum(self) -> None:
        data = self.renamed("types state values", "{on: running}")
        message = data["messages"]["m"]
        assert data["types"]["state"]["default"] == "running"
        assert message["fields"]["s"] == {"type": "state", "const": "running"}
        assert list(message["fields"]["u"]["cases"]) == ["running"]
        values = message["examples"]["e"]["values"]
        assert values["s"] == "running"
        assert values["p"] == [{"left": "running", "right": "off"}, {"left": 1}]

    def test_of_flags(self) -> None:
        example = self.renamed("messages m fields f flags", "{one: uno}")
        example = example["messages"]["m"]["examples"]["e"]
        assert example["values"]["f"] == ["uno", "hot"]
        assert example["contradicts"]["reads"]["f"] == {"uno": 1}

    def test_of_bits_and_their_values(self) -> None:
        data = self.renamed("messages m fields b bits", "{one: uno}")
        assert data["messages"]["m"]["examples"]["e"]["values"]["b"] == {"low": "one", "uno": 1}
        data = self.renamed("messages m fields b bits low values", "{one: uno}")
        assert data["messages"]["m"]["examples"]["e"]["values"]["b"] == {"low": "uno", "one": 1}

    def test_of_what_is_reserved(self) -> None:
        names = "{rename: {m: n}, n: {fields: {rename: {k: kind}}}}"
        data = merged(self.BASE, f"{{messages: {names}, types: {{rename: {{state: mode}}}}}}")
        assert isinstance(data, dict)
        assert data["reserved"]["values"] == {"n.kind": [3], "mode": [4]}


class TestShortForms:
    def of_files(self, tmp_path: Path, base: str, dialect: str) -> Any:
        (tmp_path / "base.yaml").write_text(dedent(base), encoding="utf-8")
        path = tmp_path / "a.yaml"
        path.write_text("extends: base.yaml\n" + dedent(dialect), encoding="utf-8")
        problems, sources = Problems(), SourceMap()
        document = read_document(path, problems, sources)
        assert document is not None
        result = merge_bases(document, problems, sources)
        assert result is not None
        assert list(problems) == []
        return to_data(result.root)

    def test_a_mapping_adds_to_what_a_bare_value_stands_for(self, tmp_path: Path) -> None:
        base = """
            endpoints: {a: A}
            types: {t: {fields: {sv: uint8, k: {type: uint8, values: {one: 1}, flags: {x: 2}}}}}
            messages: {m: {fields: {v: {switch: k, cases: {1: uint8}}}}}
            """
        dialect = """
            endpoints: {a: {doc: d}}
            types:
              t: {fields: {sv: {unit: m}, k: {values: {one: {doc: d}}, flags: {x: {doc: d}}}}}
            messages: {m: {fields: {v: {cases: {1: {unit: s}}}}}}
            """
        data = self.of_files(tmp_path, base, dialect)
        assert data["endpoints"] == {"a": {"title": "A", "doc": "d"}}
        fields = data["types"]["t"]["fields"]
        assert fields["sv"] == {"type": "uint8", "unit": "m"}
        assert fields["k"]["values"] == {"one": {"value": 1, "doc": "d"}}
        assert fields["k"]["flags"] == {"x": {"bit": 2, "doc": "d"}}
        case = data["messages"]["m"]["fields"]["v"]["cases"][1]
        assert case == {"type": "uint8", "unit": "s"}

    def test_a_field_of_another_kind_replaces_it(self, tmp_path: Path) -> None:
        base = "messages: {m: {fields: {a: uint8}}}"
        data = self.of_files(tmp_path, base, "messages: {m: {fields: {a: {fields: {b: uint8}}}}}")
        assert data["messages"]["m"]["fields"]["a"] == {"fields": {"b": "uint8"}}
