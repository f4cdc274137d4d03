"""Writes what JavaScript must know of the C interface: make_interface.py [--check].

src/interface.js has constants, statuses and the fields of structs in the memory of wasm32, which
wasm/layout.inl lets the compiler check; wasm/exports.cmake has the calls of each module.
"""

import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import interface  # noqa: E402

# Sizes, and the methods of DataView.
PLAIN = {
    "char": (1, "Uint8"), "uint8_t": (1, "Uint8"), "uint16_t": (2, "Uint16"),
    "uint32_t": (4, "Uint32"), "int32_t": (4, "Int32"), "gicodec_status": (4, "Int32"),
    "float": (4, "Float32"), "double": (8, "Float64"), "uint64_t": (8, "BigUint64"),
    "size_t": (4, "Uint32"),
}
POINTER = (4, "Uint32")

DESCRIPTION = r"gicodec_(status_text|version_text|format_(from_name|name)|kind_name|" \
    r"texture_desc_(check|problem|complete|info)|" \
    r"volume_desc_(create|add_group|add_texture|check|problem|destroy))"
DECODER = rf"{DESCRIPTION}|gicodec_(player_(open|destroy|container|select|select_box|set_growing|next|seek|seekable|frame|frames|read|" \
    r"changed)|container_(json|version)|" \
    r"decoder_(create|decode|set_presence|read|changed|received|sequence)|" \
    r"volume_decoder_(create|decode|read|changed)|packet_peek|backend_name)"
MODULES = {
    "decoder": DECODER,
    "client": rf"{DESCRIPTION}|gicodec_(client_(?!cancel|destroy)\w+|track_receiver_(?!destroy)\w+|reason_text|volume_desc_json)",
    "encoder": rf"{DESCRIPTION}|gicodec_(ddgi_\w+|map_texture|format_(count|at)|layout_\w+|"
    r"volume_desc_(from_layout|json)|encoder_(?!destroy)\w+|volume_encoder_(?!destroy|read|set_active)\w+|"
    r"container_(create|add_volume|set_\w+|add_metadata)|writer_(?!destroy)\w+)",
}
RUNTIME = ("_initialize", "malloc", "free")
SOURCE = ("gicodec_source_grow", "gicodec_source_arrived", "gicodec_ranges_source", "gicodec_ranges_room",
          "gicodec_ranges_missing", "gicodec_ranges_trim", "gicodec_ranges_grow")


def layout(struct):
    """Offsets, as clang lays a struct out for wasm32, and its size."""
    at, widest, fields = 0, 1, []
    for field in struct.fields:
        if field.type in known:
            size, align = known[field.type]
            kind = field.type
        else:
            size, kind = PLAIN.get(field.type, POINTER)
            align = size
        at = -(-at // align) * align
        fields.append((field.name, at, kind, field.count))
        at += size * field.count
        widest = max(widest, align)
    size = -(-at // widest) * widest
    known[struct.name] = (size, widest)
    return fields, size


known = {}


def camel(name):
    """A C name as JavaScript has it: gicodec_texture_desc, textureDesc."""
    head, *rest = name.removeprefix("gicodec_").split("_")
    return head + "".join(word.capitalize() for word in rest)


def javascript():
    found = interface.read()
    lines = ["// Made by make_interface.py from include/gicodec/c, for the memory of wasm32.", "",
             "// Statuses by number."]
    lines.append("export const STATUS_NAMES = {")
    lines += [f"  {number}: '{name}'," for number, name in found.statuses.items()]
    lines += ["};", ""]
    lines += [f"export const {name.removeprefix('GICODEC_')} = {value};"
              for name, value in found.constants.items()]
    lines += ["", "// Structs: their size, and of each field the offset, DataView's name of its type or",
              "// the struct, and the number of elements."]
    for struct in found.structs:
        fields, size = layout(struct)
        lines.append(f"export const {camel(struct.name)} = {{size: {size}, fields: {{")
        for name, at, kind, count in fields:
            kind = camel(kind) if kind in known else f"'{kind}'"
            lines.append(f"  {camel(name)}: [{at}, {kind}, {count}],")
        lines.append("}};")
    lines.append("")
    return "\n".join(lines)


def checks():
    """What the compiler finds wrong if a struct lies otherwise in memory."""
    lines = ["// Made by make_interface.py: where src/interface.js has the fields of structs."]
    for struct in interface.read().structs:
        fields, size = layout(struct)
        lines.append(f"static_assert(sizeof({struct.name}) == {size});")
        lines += [f"static_assert(offsetof({struct.name}, {name}) == {at});"
                  for name, at, _, _ in fields]
    return "\n".join(lines) + "\n"


def cmake():
    names = [call.name for call in interface.read().calls]
    lines = ["# Made by make_interface.py."]
    for module, pattern in MODULES.items():
        chosen = [name for name in names if re.fullmatch(pattern, name)]
        extra = SOURCE if module == "decoder" else ()
        lines.append(f"set({module}_exports")
        lines += [f"  {name}" for name in (*RUNTIME, *extra, *chosen)]
        lines.append(")")
    return "\n".join(lines) + "\n"


def main():
    made = {HERE / "src" / "interface.js": javascript(), HERE / "wasm" / "layout.inl": checks(),
            HERE / "wasm" / "exports.cmake": cmake()}
    for target, text in made.items():
        if "--check" not in sys.argv:
            target.write_text(text, encoding="utf-8")
        elif target.read_text(encoding="utf-8") != text:
            sys.exit(f"{target.name} is not that of include/gicodec/c: run make_interface.py")


if __name__ == "__main__":
    main()
