"""Fingerprints of code: what compiled results depend on, comments and docstrings apart."""

import ast
from functools import cache
from hashlib import sha256
from pathlib import Path

PACKAGE = Path(__file__).parents[1]


@cache
def room_hash(*rooms: str) -> str:
    """Hash of the syntax of all modules of some folders of the package, constants included.

    Parameters
    ----------
    *rooms : str
        Folders below ``sebody/``, such as ``"kernels"``.

    Raises
    ------
    FileNotFoundError
        A folder without modules: what is compiled would never be found stale.
    """
    digest = sha256()
    for room in rooms:
        paths = sorted((PACKAGE / room).glob("*.py"))
        if not paths:
            raise FileNotFoundError(f"{PACKAGE / room} holds no modules: its hash would be empty")
        for path in paths:
            digest.update(f"{room}/{path.name}:{syntax(path.read_text(encoding='utf-8'))}".encode())
    return digest.hexdigest()[:12]


def syntax(text: str) -> str:
    """The syntax tree of a module as text, the same for every version of Python.

    Fields that are empty are left out: new versions add such. Docstrings are left out, too.
    """
    return _described(ast.parse(text))


def _described(node: object) -> str:
    if isinstance(node, list):
        return "[" + ",".join(map(_described, node)) + "]"
    if not isinstance(node, ast.AST):
        return repr(node)
    fields = []
    for name in node._fields:
        value = getattr(node, name, None)
        if name == "body" and isinstance(value, list) and _is_docstring(node, value):
            value = value[1:]
        if value is not None and value != []:
            fields.append(f"{name}={_described(value)}")
    return f"{type(node).__name__}({','.join(fields)})"


def _is_docstring(node: ast.AST, body: list) -> bool:
    scopes = ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef
    return (isinstance(node, scopes) and bool(body) and isinstance(body[0], ast.Expr)
            and isinstance(body[0].value, ast.Constant) and isinstance(body[0].value.value, str))
