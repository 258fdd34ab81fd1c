// The page by keyboard alone, by pointer, and without colour.

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/page/page_in_browser.h"

namespace grainfield::report {
namespace {

using nlohmann::json;

using PageByHand = PageInBrowser;

TEST_F(PageByHand, ReachesEveryControlWithTabAndShowsWhereItIs) {
    browser_->open_page(page({film_in_space(1, "tracked"), film(2, "true positions")}), 1366, 768);
    // What a pointer can do something with.
    const json expected = browser_->evaluate(R"JS((() => {
        document.querySelectorAll("details").forEach((d) => { d.open = true; });
        const all = [...document.querySelectorAll("a, button, select, input, summary, .stage, .patch, .term, .modebar-btn")]
            .filter((e) => e.checkVisibility({visibilityProperty: true}));
        all.forEach((e, i) => { e.dataset.order = String(i); });
        return all.map((e) => `${e.tagName}.${e.className} ${e.title || e.textContent.slice(0, 30)}`);
    })())JS");
    ASSERT_GT(expected.size(), 40U);
    std::set<std::size_t> reached;
    std::vector<std::string> hidden;
    long before = -1;
    int backwards = 0;
    for (std::size_t i = 0; i < expected.size() + 5; ++i) {
        browser_->press("Tab");
        const json now = browser_->evaluate(R"JS((() => {
            const e = document.activeElement;
            if (!e || e === document.body || e.dataset.order === undefined) return null;
            const style = getComputedStyle(e);
            const box = e.getBoundingClientRect();
            const seen = e.checkVisibility({opacityProperty: true, visibilityProperty: true}) && box.bottom > 0 && box.top < innerHeight && box.width > 0;
            return [Number(e.dataset.order), style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1 && seen];
        })())JS");
        if (now.is_null()) break;
        const auto place = now[0].get<long>();
        reached.insert(static_cast<std::size_t>(place));
        if (!now[1].get<bool>()) hidden.push_back(expected[static_cast<std::size_t>(place)]);
        backwards += place < before;
        before = place;
    }
    std::vector<std::string> missed;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (!reached.contains(i)) missed.push_back(expected[i]);
    }
    EXPECT_THAT(missed, testing::IsEmpty()) << "out of reach of the keyboard";
    EXPECT_THAT(hidden, testing::IsEmpty()) << "in focus, and nothing shows it";
    EXPECT_EQ(backwards, 0) << "the order of reading";
}

TEST_F(PageByHand, DoesWithKeysWhatAPointerDoes) {
    browser_->open_page(page({film(1, "layer")}), 1366, 768);
    const auto focus = [&](const std::string& selector) {
        EXPECT_EQ(browser_->evaluate("(() => { const e = document.querySelector('" + selector +
                                     "'); e.focus(); return document.activeElement === e; })()"),
                  true)
            << selector;
    };
    focus("#map .kinds button[value=discs]");
    browser_->press(" ");
    EXPECT_EQ(browser_->evaluate("document.querySelector('#map .kinds "
                                 "button[value=discs]').getAttribute('aria-pressed')"),
              "true");
    focus(".pick-frame");
    browser_->press("ArrowRight");
    EXPECT_EQ(browser_->evaluate("document.querySelector('.frames output').textContent"), "40");
    focus("details summary");
    browser_->press("Enter");
    EXPECT_EQ(browser_->evaluate("document.querySelector('details').open"), true);
    const std::string range =
        "(() => { const r = document.querySelector('.figures .plot')._fullLayout.xaxis.range; "
        "return Math.abs(r[1] - r[0]); })()";
    const double all = browser_->evaluate(range).get<double>();
    focus(".figures .modebar-btn[data-title=\"Zoom in\"]");
    browser_->press("Enter");
    browser_->evaluate("new Promise((done) => setTimeout(done, 500))");
    EXPECT_LT(browser_->evaluate(range).get<double>(), 0.8 * all) << "a curve, closer";
}

TEST_F(PageByHand, CopiesSettingsAndGoesToMarkedSpheres) {
    RunPlan plan;
    const Results run = film(1, "frames");
    const Vec2 at = run.previews[0].snapshot.position[11];
    write_report({run, film(2, "residual")}, {.title = "Settings", .observables = false},
                 folder_ / "report.html", folder_ / "figures", plan,
                 {.tables = {},
                  .figures = {},
                  .verdict = "1 missed",
                  .blocks = {{"Settings", "[calibrate]\npolarity = \"dark\"\n"}},
                  .marked = {{0, 0, at, "missed"}},
                  .marked_as = "Missed and false"});
    browser_->open_page(folder_ / "report.html", 1366, 768);
    EXPECT_EQ(browser_->evaluate("document.querySelector('.verdict').textContent.split(';')[0]"),
              "1 missed");
    EXPECT_LE(
        browser_->evaluate("document.querySelector('#map .stage').getBoundingClientRect().bottom")
            .get<double>(),
        768)
        << "the picture comes first";
    browser_->evaluate("document.querySelector('.copy').focus()");
    browser_->press("Enter");
    EXPECT_EQ(browser_->evaluate("String(getSelection())"), "[calibrate]\npolarity = \"dark\"");
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('.place').length"), 1)
        << "and no others";
    EXPECT_EQ(browser_->evaluate("document.querySelector('.places').textContent.split(':')[0]"),
              "Missed and false");
    browser_->evaluate("document.querySelector('.place').click()");
    browser_->evaluate("new Promise((done) => setTimeout(done, 500))");
    const double x =
        browser_
            ->evaluate(
                "(() => { const r = document.querySelector('#map .plot')._fullLayout.xaxis.range; "
                "return (r[0] + r[1]) / 2; })()")
            .get<double>();
    EXPECT_NEAR(x, at.x, 0.01);
    EXPECT_THAT(
        browser_->evaluate("document.querySelector('.readout').textContent").get<std::string>(),
        testing::HasSubstr("missed at x"));
}

TEST_F(PageByHand, SlidersShowWhatOtherSettingsFindAndTheSettings) {
    Alternatives all;
    all.title = "Other settings";
    all.picture = Image(100, 80, 0);
    all.picture(0, 0) = 255;
    all.axes = {{"Polarity", {"dark", "bright"}, 0}, {"Diameter", {"20 px", "30 px"}, 0}};
    for (const double diameter : {20.0, 30.0, 20.0, 30.0}) {
        const std::string count = std::to_string(all.tried.size());
        all.tried.push_back({{{49.5, 39.5}}, diameter, count + " spheres", "evidence = " + count});
    }
    RunPlan plan;
    write_report({film(1, "frames")}, {.title = "Settings", .observables = false},
                 folder_ / "report.html", folder_ / "figures", plan,
                 {.tables = {}, .figures = {}, .alternatives = all});
    browser_->open_page(folder_ / "report.html", 1366, 768);
    const auto text = [&](const std::string& selector) {
        return browser_->evaluate("document.querySelector('.alternatives " + selector +
                                  "').textContent");
    };
    // Whether the picture is marked at this many of its pixels to the right of the sphere.
    const auto is_marked = [&](double r) {
        return browser_->evaluate(
            "(() => { const c = document.querySelector('.alternatives canvas'); "
            "const zoom = c.width / 100; "
            "const p = c.getContext('2d').getImageData((50 + " +
            std::to_string(r) + ") * zoom, 40 * zoom, 1, 1).data; return p[0] > 150; })()");
    };
    EXPECT_EQ(text(".found"), "0 spheres");
    EXPECT_EQ(is_marked(10), true);
    EXPECT_EQ(is_marked(15), false);
    browser_->evaluate("document.querySelectorAll('.alternatives input')[1].focus()");
    browser_->press("ArrowRight");
    EXPECT_EQ(text(".found"), "1 spheres");
    EXPECT_EQ(text("pre"), "evidence = 1");
    EXPECT_EQ(text("label:nth-of-type(2) output"), "30 px");
    EXPECT_EQ(is_marked(10), false);
    EXPECT_EQ(is_marked(15), true);
    browser_->evaluate("document.querySelectorAll('.alternatives input')[0].focus()");
    browser_->press("ArrowRight");
    EXPECT_EQ(text("pre"), "evidence = 3");
    browser_->evaluate("document.querySelector('.alternatives .copy').focus()");
    browser_->press("Enter");
    EXPECT_EQ(browser_->evaluate("String(getSelection())"), "evidence = 3");
    EXPECT_LT(browser_
                  ->evaluate("document.querySelector('#map').getBoundingClientRect().bottom - "
                             "document.querySelector('.alternatives').getBoundingClientRect().top")
                  .get<double>(),
              0)
        << "the picture first";
    browser_->open_page(folder_ / "report.html", 390, 844);
    EXPECT_EQ(browser_->evaluate(too_wide), "");
    EXPECT_EQ(browser_->evaluate("document.documentElement.dataset.errors ?? ''"), "");
}

TEST_F(PageByHand, IsReadInGrey) {
    std::vector<Results> runs;
    for (std::uint64_t i = 1; i <= 4; ++i) runs.push_back(film(i, "run " + std::to_string(i)));
    runs[0] = film_in_space(1, "run 1");
    browser_->open_page(page(runs), 1366, 768);
    // WCAG: text needs 4.5 times the luminance of its ground, or the reverse; luminance is what
    // grey keeps.
    const json faint = browser_->evaluate(R"JS((() => {
        const channels = (text) => (text.match(/[\d.]+/g) || [0, 0, 0, 0]).map(Number);
        const luminance = ([r, g, b]) => [r, g, b].map((c) => c / 255)
            .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
            .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
        const ground = (e) => {
            for (; e; e = e.parentElement) {
                const c = channels(getComputedStyle(e).backgroundColor);
                if (c.length === 3 || c[3] === 1) return luminance(c);
            }
            return 1;
        };
        const walker = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
        const faint = new Set();
        while (walker.nextNode()) {
            const e = walker.currentNode.parentElement;
            if (!walker.currentNode.textContent.trim() || !e.getClientRects().length || e.closest("script, style")) continue;
            if (e.matches(".glyph, .block, .swatch")) continue;
            const style = getComputedStyle(e);
            const ink = luminance(channels(e.closest("svg") ? style.fill : style.color));
            const [low, high] = [ink, ground(e)].sort((a, b) => a - b);
            if ((high + 0.05) / (low + 0.05) < 4.5) faint.add(`${e.tagName}.${e.className.baseVal ?? e.className} ${e.textContent.slice(0, 20)}`);
        }
        return [...faint];
    })())JS");
    EXPECT_THAT(faint, testing::IsEmpty()) << "text";
    // Runs are told by symbols where colours fail.
    const json alike =
        browser_->evaluate(R"JS([...document.querySelectorAll(".figures .plot")].filter((plot) => {
        const runs = new Map();
        for (const t of plot.data) {
            if (t.visible === false || !(t.mode || "").includes("markers")) continue;
            runs.set(t.meta.run, t.marker.symbol);
        }
        return new Set(runs.values()).size !== runs.size;
    }).map((plot) => plot.id))JS");
    EXPECT_THAT(alike, testing::IsEmpty()) << "runs with one symbol";
    // What is pressed differs from what is not by more than hue.
    const json pressed = browser_->evaluate(R"JS((() => {
        const border = (e) => getComputedStyle(e).borderTopColor.match(/[\d.]+/g).map(Number);
        const grey = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
        const [on, off] = ["true", "false"].map((p) => document.querySelector(`#map .kinds button[aria-pressed=${p}]`));
        return Math.abs(grey(border(on)) - grey(border(off)));
    })())JS");
    EXPECT_GT(pressed.get<double>(), 50) << "of 255";
}

}  // namespace
}  // namespace grainfield::report
