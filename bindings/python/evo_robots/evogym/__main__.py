"""python -m evo_robots.evogym SCRIPT [ARGUMENT]..., or -m MODULE, -c PROGRAM, -: runs a program that
says ``import evogym`` on this simulator, without changing a letter."""

from __future__ import annotations

import os
import runpy
import sys
from pathlib import Path


def main(arguments: list[str]) -> None:
    option = arguments[0] if arguments[:1] in (["-m"], ["-c"]) else ""
    if option:
        arguments = arguments[1:]
    if not arguments or not option and arguments[0] in ("-h", "--help"):
        print("usage: python -m evo_robots.evogym (SCRIPT | -m MODULE | -c PROGRAM | -) [ARGUMENT]...\n"
              'runs a program that says "import evogym" on this simulator')
        sys.exit(0 if arguments else 2)
    stand_in = str(Path(__file__).parent / "shim")
    # Processes that it starts find the stand-in, too.
    os.environ["PYTHONPATH"] = os.pathsep.join(
        [stand_in, str(Path(__file__).parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])])
    sys.path.insert(0, stand_in)
    import evogym  # noqa: F401

    sys.argv = arguments
    if option or arguments[0] == "-":
        sys.path.insert(0, os.getcwd())
    if option == "-m":
        runpy.run_module(arguments[0], run_name="__main__", alter_sys=True)
    elif option == "-c":
        sys.argv, program = ["-c", *arguments[1:]], arguments[0]
        exec(compile(program, "<string>", "exec"), {"__name__": "__main__"})
    elif arguments[0] == "-":
        exec(compile(sys.stdin.read(), "<stdin>", "exec"), {"__name__": "__main__"})
    elif not os.path.isfile(arguments[0]):
        sys.exit(f"python -m evo_robots.evogym: there is no file {arguments[0]}")
    else:
        sys.path.insert(0, str(Path(arguments[0]).resolve().parent))
        runpy.run_path(os.path.abspath(arguments[0]), run_name="__main__")  # which is __file__ there, as in Python


main(sys.argv[1:])
