"""What the headers of the C interface declare: constants, structs and calls.

The headers keep to a few forms, which this file reads; what it cannot read is an error. The bindings of
Python and JavaScript are made from it (python/make_interface.py, js/make_interface.py), so that they
know each struct and call as the library does.
"""

import dataclasses
import pathlib
import re

HEADERS = ("base", "description", "encoder", "decoder", "container", "client", "server", "tracks")
FOLDER = pathlib.Path(__file__).resolve().parent.parent / "include" / "gicodec" / "c"


@dataclasses.dataclass(frozen=True)
class Field:
    """A field of a struct, or a parameter of a call."""

    name: str
    type: str  # "uint32_t", "const gicodec_view*", "void**", "function"
    count: int = 1  # of an array's elements


@dataclasses.dataclass(frozen=True)
class Struct:
    name: str
    fields: tuple


@dataclasses.dataclass(frozen=True)
class Call:
    name: str
    result: str
    parameters: tuple


@dataclasses.dataclass(frozen=True)
class Interface:
    constants: dict
    statuses: dict  # number: name, "checksum_mismatch"
    handles: tuple  # names of opaque structs
    structs: tuple
    calls: tuple


def _plain(header):
    """Without comments, directives and the C++ around it."""
    text = re.sub(r"//[^\n]*", "", header)
    text = re.sub(r"^\s*#(.*\\\n)*.*$", "", text, flags=re.M)
    return text.replace('extern "C" {', "")


def _type(words):
    """A type without spaces; const where what it points to is."""
    plain = re.sub(r"\bconst\b|\s", "", words)
    return f"const {plain}" if words.startswith("const ") else plain


def _number(text, constants):
    return constants[text] if text in constants else int(text, 0)


def _field(text, constants):
    """Fields of one declaration: "float eye[3], target[3]", or a pointer to a function."""
    function = re.fullmatch(r"[\w\s*]+\(\*(\w+)\)\(.*\)", text, re.S)
    if function:
        return [Field(function[1], "function")]
    head = re.match(r"((?:const\s+)?\w+(?:\s*(?:const)?\s*\*(?:\s*const)?)*)\s*", text)
    fields = []
    for name in text[head.end():].split(","):
        array = re.fullmatch(r"\s*(\w+)(?:\[(\w+)\])?\s*", name)
        if not array:
            raise ValueError(f"a field that is not understood: {text}")
        count = _number(array[2], constants) if array[2] else 1
        fields.append(Field(array[1], _type(head[1]), count))
    return fields


def _parameter(text, constants):
    (field,) = _field(text.strip(), constants)
    if field.count != 1:  # an array decays
        return Field(field.name, field.type + "*")
    return field


def read(folder=FOLDER):
    """The interface of all headers."""
    constants, statuses, handles, structs, calls = {}, {}, [], [], []
    for header in HEADERS:
        raw = (folder / f"{header}.h").read_text(encoding="utf-8")
        for name, value in re.findall(r"#define (GICODEC_[A-Z_0-9]+) UINT32_(MAX)", raw):
            constants[name] = 0xFFFFFFFF
        text = _plain(raw)
        for body in re.findall(r"enum \{(.*?)\}", text, re.S):
            pairs = {name: int(value, 0)
                     for name, value in re.findall(r"(GICODEC_\w+) = (\w+)", body)}
            constants.update(pairs)
            if "GICODEC_OK" in pairs:
                statuses = {number: name.removeprefix("GICODEC_").lower()
                            for name, number in pairs.items()}
        handles += re.findall(r"typedef struct (\w+) \1;", text)
        for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", text, re.S):
            fields = []
            for declaration in body.split(";"):
                if declaration.strip():
                    fields += _field(" ".join(declaration.split()), constants)
            structs.append(Struct(name, tuple(fields)))
        for declaration in re.findall(r"GICODEC_C_API\s([^;]+);", text):
            form = re.fullmatch(r"(.+?)\s*(gicodec_\w+)\((.*)\)", " ".join(declaration.split()))
            if not form:
                raise ValueError(f"a call that is not understood: {declaration}")
            parameters = () if form[3] == "void" else tuple(
                _parameter(one, constants) for one in form[3].split(","))
            calls.append(Call(form[2], _type(form[1]), parameters))
    return Interface(constants, statuses, tuple(handles), tuple(structs), tuple(calls))
