"""Writes gicodec/_interface.py, what ctypes must know of the C interface: make_interface.py [--check]."""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import interface  # noqa: E402

PLAIN = {
    "char": "ctypes.c_char", "const char*": "ctypes.c_char_p", "double": "ctypes.c_double",
    "float": "ctypes.c_float", "gicodec_status": "ctypes.c_int32", "int32_t": "ctypes.c_int32",
    "uint8_t": "ctypes.c_uint8", "uint16_t": "ctypes.c_uint16", "uint32_t": "ctypes.c_uint32",
    "uint64_t": "ctypes.c_uint64", "size_t": "ctypes.c_size_t", "void": "None",
}


def of_type(name):
    """What ctypes calls it. Pointers are addresses: the caller keeps alive what they point to."""
    if name in PLAIN:
        return PLAIN[name]
    if name == "function" or name.endswith("*"):
        return "ctypes.c_void_p"
    return name


def of_field(field):
    kind = of_type(field.type)
    return f'("{field.name}", {kind}{f" * {field.count}" if field.count > 1 else ""})'


def text():
    found = interface.read()
    lines = ['"""Made by make_interface.py from include/gicodec/c. Pointers are addresses."""', "",
             "import ctypes", ""]
    lines += [f'{name.removeprefix("GICODEC_")} = {value}'
              for name, value in found.constants.items()]
    lines += ["", "# Names of statuses.", f"STATUS_NAMES = {found.statuses}"]
    for struct in found.structs:
        lines += ["", "", f"class {struct.name}(ctypes.Structure):", "    _fields_ = ["]
        lines += [f"        {of_field(field)}," for field in struct.fields]
        lines += ["    ]"]
    lines += ["", "", "# What each call returns, and takes.", "CALLS = {"]
    for call in found.calls:
        taken = ", ".join(of_type(one.type) for one in call.parameters)
        lines.append(f'    "{call.name}": ({of_type(call.result)}, ({taken}{"," if taken else ""})),')
    lines += ["}", "# Calls whose result is a status.", "FALLIBLE = frozenset((",
              *(f'    "{call.name}",' for call in found.calls if call.result == "gicodec_status"),
              "))", ""]
    return "\n".join(lines)


def main():
    target = HERE / "gicodec" / "_interface.py"
    if "--check" in sys.argv:
        if target.read_text(encoding="utf-8") != text():
            sys.exit("gicodec/_interface.py is not that of include/gicodec/c: run make_interface.py")
    else:
        target.write_text(text(), encoding="utf-8")


if __name__ == "__main__":
    main()
