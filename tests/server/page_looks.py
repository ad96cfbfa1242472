# SPDX-License-Identifier: Apache-2.0
"""Checks of access and looks of the page: names, tab order, focus, contrast, themes, and widths of 390 px and 1600 px."""
from visitor import HTML, Visitor, entry, insist

NAMELESS = """[...document.querySelectorAll('button, input, select, textarea, [role=img], [tabindex="0"]')].filter((e) => e.offsetParent !== null || e.namespaceURI.endsWith('svg'))
  .filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.closest('label')?.textContent.trim()))
  .map((e) => e.outerHTML.slice(0, 120))"""


def check_access(visitor):
    """Every control has a name, and the keyboard reaches it in the order of the page."""
    insist(not visitor.value(NAMELESS), f"controls without a name: {visitor.value(NAMELESS)}")
    insist(visitor.value("[...document.querySelectorAll('img')].every((i) => i.hasAttribute('alt'))"), "images have alternative texts")
    visitor.value("(document.activeElement?.blur(), window.getSelection()?.removeAllRanges(), document.querySelector('.skip').focus())")
    reached = []
    for _ in range(14):
        visitor.key("Tab")
        reached.append(visitor.value("(() => { const a = document.activeElement; const r = a.getBoundingClientRect();"
                                     " return [(a.getAttribute('aria-label') || a.textContent).trim().slice(0, 40), a.matches(':focus-visible') && getComputedStyle(a).outlineStyle]; })()"))
    insist(len({name for name, _ in reached}) >= 10, f"Tab moves through the page: {reached}")
    insist(all(ring == "solid" for _, ring in reached), f"the focus is visible: {reached}")


def luminance(colour):
    parts = [int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def check_contrast(visitor, theme):
    """WCAG 2.1: 4.5 for text on cards, panels and the page."""
    colours = visitor.value(f"Object.fromEntries(['ink', 'ink-soft', 'good', 'bad', 'link', 'card', 'back', 'panel', 'action', 'action-ink', 'fair']"
                            f".map((name) => [name, getComputedStyle({HTML}).getPropertyValue('--' + name).trim()]))")
    pairs = [(ink, paper) for ink in ("ink", "ink-soft", "good", "bad", "link", "fair") for paper in ("card", "back", "panel")] + [("action-ink", "action")]
    for ink, paper in pairs:
        light, dark = sorted([luminance(colours[ink]), luminance(colours[paper])], reverse=True)
        insist((light + 0.05) / (dark + 0.05) >= 4.5, f"{theme}: {ink} on {paper} has too little contrast")


def check_looks(browser, address):
    """Light and dark, 1600 px and 390 px: nothing overhangs, and the switch overrules the system."""
    for width, height in ((1600, 950), (390, 844)):
        for theme in ("light", "dark"):
            visitor = Visitor(browser.open(address, width=width, height=height, dark=theme == "dark"))
            insist(visitor.value(f"{HTML}.dataset.theme") == theme, f"{theme} as the system")
            check_contrast(visitor, theme)
            for step, ready in (("setup", "document.querySelectorAll('.marker').length >= 5"), ("results", "document.querySelector('.results .u-over')")):
                if step == "setup":
                    visitor.click(entry("bridge.mp4"))
                visitor.click(f"document.querySelector('#tab-{step}')")
                visitor.wait(ready)
                if (step, width) == ("results", 390):
                    inner = visitor.value("(() => { const t = document.querySelector('.headline .wide'); return [t.scrollWidth - t.clientWidth, t.querySelectorAll('td').length,"
                                          " [...t.querySelectorAll('td')].every((c) => c.getBoundingClientRect().right <= innerWidth && getComputedStyle(c, '::before').content.length > 2)]; })()")
                    insist(inner[0] <= 0 and inner[1] >= 6 and inner[2], f"the table of results needs no sideways scroll, and each value has its heading: {inner}")
                overhang = visitor.value("document.querySelector('#main').scrollWidth - document.querySelector('#main').clientWidth")
                insist(overhang <= 0, f"{step} at {width} px: {overhang} px overhang")
    visitor.click("document.querySelector('#theme')")
    insist(visitor.value(f"{HTML}.dataset.theme") == "light", "the switch overrules the system")
    visitor.click("document.querySelector('#theme')")
    visitor.click("document.querySelector('#theme')")
