"""The sign-in page: one form, without scripts and without other files, for wide and narrow screens, light and dark."""

from html import escape
from urllib.parse import urlencode

from starlette.responses import Response

from thetascope.messages import Message
from thetascope.messages.catalogue import languages

HEADERS = {
    # Only this page may send its address to itself: with "no-referrer" a browser sends `Origin: null` with the form.
    "Referrer-Policy": "same-origin",
    "Cache-Control": "no-store",
    "Content-Security-Policy": (
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; form-action 'self'; base-uri 'none'; "
        "frame-ancestors 'none'"
    ),
}
NAMES = {"en": "English", "zh": "中文"}
"""Languages by their own names."""

_STYLE = """
:root { color-scheme: light dark; --bg: #f6f5f1; --card: #fff; --ink: #1b1f24; --soft: #59626d; --line: #8a8f96;
  --accent: #0072b2; --on-accent: #fff; --alarm: #b03a08; }
@media (prefers-color-scheme: dark) { :root { --bg: #0e1216; --card: #151a20; --ink: #e9e7e2; --soft: #a3adb8;
  --line: #66717d; --accent: #56b4e9; --on-accent: #06131c; --alarm: #fb7a3c; } }
* { box-sizing: border-box; }
body { margin: 0; min-height: 100vh; display: grid; place-items: center; padding: 1rem; background: var(--bg);
  color: var(--ink); font: 1rem/1.5 ui-sans-serif, system-ui, 'Segoe UI', Roboto, 'Noto Sans', 'Noto Sans SC',
  sans-serif; }
main { width: 100%; max-width: 26rem; padding: 1.5rem; background: var(--card); border-radius: 0.75rem; }
h1 { margin: 0 0 0.75rem; font-size: 1.4rem; }
p { margin: 0 0 1rem; }
label { display: block; font-weight: 600; margin-bottom: 0.25rem; }
input, button { width: 100%; min-height: 2.75rem; padding: 0.5rem 0.75rem; font: inherit; border-radius: 0.5rem; }
input { border: 1px solid var(--line); background: var(--bg); color: var(--ink); }
button { margin: 1rem 0; border: 0; background: var(--accent); color: var(--on-accent); font-weight: 600;
  cursor: pointer; }
:focus-visible { outline: 3px solid var(--accent); outline-offset: 2px; }
.soft { color: var(--soft); font-size: 0.9rem; }
.problem { margin: 0.75rem 0 0; color: var(--alarm); font-weight: 600; }
nav a, nav span { display: inline-block; padding: 0.5rem 0.75rem 0.5rem 0; }
a { color: var(--accent); }
"""


def sign_in_page(language: str, goal: str, problem: Message | None = None, status: int = 200) -> Response:
    """Return the page; `goal` is the address to go to afterwards, `problem` why an attempt failed."""

    def say(code: str) -> str:
        return escape(Message(code).text(language))

    failed = problem is not None
    alert = f'<p class="problem" id="problem" role="alert">{escape(problem.text(language))}</p>' if problem else ""
    wrong = ' aria-invalid="true" aria-describedby="problem"' if failed else ""
    document = f"""<!doctype html>
<html lang="{language}"><head><meta charset="utf-8"><title>{say("access.page.title")}</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><meta name="robots" content="noindex">
<link rel="icon" href="data:,"><style>{_STYLE}</style></head>
<body><main><h1>Thetascope</h1><p>{say("access.page.reason")}</p>
<form method="post">
<label for="key">{say("access.page.key")}</label>
<input id="key" name="key" type="password" required autofocus autocomplete="current-password" autocapitalize="none"
 spellcheck="false" maxlength="200"{wrong}>{alert}
<button type="submit">{say("access.page.sign-in")}</button></form>
<p class="soft">{say("access.page.where")}</p>
<nav>{_languages(language, goal)}</nav></main></body></html>
"""
    return Response(document, status, HEADERS, "text/html; charset=utf-8")


def _languages(language: str, goal: str) -> str:
    """Return the links to the page in its languages; the present one is not a link."""

    def link(tag: str) -> str:
        name = NAMES.get(tag, tag)
        if tag == language:
            return f'<span aria-current="true">{name}</span>'
        query = urlencode({"next": goal, "lang": tag})
        return f'<a href="/sign-in?{escape(query)}" lang="{tag}" hreflang="{tag}">{name}</a>'

    return " ".join(link(tag) for tag in languages())
