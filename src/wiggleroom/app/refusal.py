"""What an address without its token shows: what is missing and what to do, or the page again where its tab still knows the token."""

from __future__ import annotations

import base64
import hashlib

_STYLE = (
    "body{font:18px/1.5 system-ui,sans-serif;max-width:34em;margin:18vh auto;padding:0 1.5em;"
    "color:CanvasText;background:Canvas}code{font-size:.95em}"
)
# The page takes the token out of the address and keeps it under this name for its tab and its browser; a reload or a link to a design
# comes here and goes on to it.
_SCRIPT = (
    "try{const name='wiggleroom.token',kept=sessionStorage.getItem(name)??localStorage.getItem(name);"
    "if(kept&&!new URL(location.href).searchParams.has('token'))"
    "location.replace('/?token='+encodeURIComponent(kept)+location.hash)}catch{}"
)


def _hashed(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


REFUSAL_POLICY = (
    f"default-src 'none'; script-src {_hashed(_SCRIPT)}; style-src {_hashed(_STYLE)}; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'; img-src data:"
)
REFUSAL = (
    '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
    '<meta name="viewport" content="width=device-width, initial-scale=1"><meta name="color-scheme" content="light dark">'
    f'<title>wiggleroom</title><link rel="icon" href="data:,"><script>{_SCRIPT}</script><style>{_STYLE}</style></head>\n'
    "<body><main><p>This address lacks the token that belongs to it: open the whole address that <code>wiggleroom serve"
    "</code> printed in its terminal, or start <code>wiggleroom serve</code> again.</p></main></body></html>\n"
)
