"""A page in a headless browser at the widths of a desk, a tablet and a telephone: its structure as it is laid out."""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
WIDTHS = (1280, 768, 390)
SECONDS = 120
# one frame for each width; what is measured becomes the text of the page
MEASURE = """
const place = element => { const r = element.getBoundingClientRect();
  return {left: r.left, right: r.right, top: r.top, bottom: r.bottom}; };
const measured = [...document.querySelectorAll("iframe")].map(frame => {
  const page = frame.contentDocument, ids = {};
  for (const element of page.querySelectorAll("[id]"))
    if (!element.closest("svg")) ids[element.id] = place(element);
  const letters = [...page.querySelectorAll("figure svg text")].filter(text => text.checkVisibility())
    .map(text => text.getBoundingClientRect().height);
  return {width: page.documentElement.clientWidth, scroll: page.documentElement.scrollWidth,
    height: page.documentElement.scrollHeight, ids: ids, letters: letters,
    open: [...page.querySelectorAll("details.experiment")].map(one => one.open)};
});
document.body.textContent = "MEASURED" + JSON.stringify(measured) + "END";
"""


def measured(page, folder):
    """{width: places of the identifiers, heights of the letters, ...} of a page; `folder`: of the browser."""
    address = Path(page).resolve().as_uri()
    frames = "".join(
        f'<iframe src="{address}" style="width:{width}px;height:900px;border:0"></iframe>'
        for width in WIDTHS
    )
    wrapper = folder / "frames.html"
    script = f"<script>window.onload = () => {{ {MEASURE} }}</script>"
    wrapper.write_text(f"<!doctype html><body>{frames}{script}</body>", encoding="utf-8")
    command = [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    command += ["--allow-file-access-from-files", f"--user-data-dir={folder / 'profile'}"]
    command += ["--window-size=1400,900", wrapper.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS, check=True)
    (text,) = re.findall("MEASURED(.*)END", done.stdout)
    return dict(zip(WIDTHS, json.loads(html.unescape(text)), strict=True))
