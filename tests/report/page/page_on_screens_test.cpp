// The page as people meet it: on the screen of a laptop and of a telephone, with the keyboard
// alone, without colour, and within a second.

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "report/report.h"
#include "tests/report/page/chromium_session.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using nlohmann::json;

// A layer with everything that a film may have: places to look at, identities, layers, frames.
Results film(std::uint64_t seed, const std::string& label) {
    Results run = sample::results({seed, 300, 80, true, label});
    run.previews.resize(3, run.previews.front());
    for (std::size_t p = 0; p < run.previews.size(); ++p) {
        Snapshot& snapshot = run.previews[p].snapshot;
        snapshot.frame = run.previews[p].frame.index = static_cast<std::int64_t>(40 * p);
        snapshot.quality.assign(snapshot.size(), 0.03);
        snapshot.quality[7] = 0.5;
        for (std::size_t i = 0; i < snapshot.size(); ++i) {
            snapshot.layer.push_back(i % 3 == 0 ? Layer::top : Layer::bottom);
            snapshot.id.push_back(static_cast<std::int64_t>(i));
        }
    }
    run.record.warnings = {{.text = "a warning that says what happened and what can be done"}};
    return run;
}

// The same with heights in two layers, every fifth of them uncertain.
Results film_in_space(std::uint64_t seed, const std::string& label) {
    Results run = film(seed, label);
    for (Preview& preview : run.previews) {
        Snapshot& snapshot = preview.snapshot;
        for (std::size_t i = 0; i < snapshot.size(); ++i) {
            snapshot.z.push_back((i % 3 == 0 ? 1.3 : 0.5) * run.source.diameter);
            snapshot.z_error.push_back((i % 5 == 0 ? 0.24 : 0.02) * run.source.diameter);
        }
    }
    return run;
}

Results critical_point() {
    Results run;
    run.label = "critical";
    run.identity.role = RunRole::critical_point;
    ObservableResult critical;
    critical.name = "critical";
    critical.measurements = {{"critical_value", "-", 4.7, 0.1, 3, ""}};
    critical.curves = {{"critical",
                        "",
                        {{"x", "-", "Γ", {3.5, 4, 4.5}},
                         {"s0_over_s1", "-", "", {0.3, 0.2, 0.05}},
                         {"err", "-", "", {0.05, 0.05, 0.05}}},
                        {}}};
    run.observables = {critical};
    return run;
}

class PageOnScreens : public testing::Test {
 protected:
    void SetUp() override {
        if (!ChromiumSession::is_installed())
            GTEST_SKIP() << "no Chromium here (Debian: apt-get install chromium)";
        browser_.emplace(folder_ / "profile");
    }

    std::filesystem::path page(const std::vector<Results>& runs, bool paper = false) {
        RunPlan plan;
        write_report(runs,
                     {.title = "",
                      .figures = runs.size() < 4,
                      .paper = paper,
                      .hints = analysis::figure_hints(),
                      .titles = analysis::titles()},
                     folder_ / "report.html", folder_ / "figures", plan);
        return folder_ / "report.html";
    }

    const sample::TemporaryFolder folder_{"page_on_screens"};
    std::optional<ChromiumSession> browser_;
};

// What reaches beyond the right edge without a bar of its own to scroll it by.
constexpr const char* too_wide = R"JS((() => {
    const edge = document.documentElement.clientWidth;
    const root = document.scrollingElement;
    if (root.scrollWidth <= edge) return "";
    return `${root.scrollWidth} px of ${edge}: ` + [...document.querySelectorAll("main *")]
        .filter((e) => !e.closest(".scroll *, .plot *, .meaning") && e.getBoundingClientRect().right > edge + 0.5)
        .map((e) => e.tagName + "." + e.className).slice(0, 8).join(" ");
})())JS";

TEST_F(PageOnScreens, FitsALaptopAndATelephoneWithoutScrollingSideways) {
    const std::vector<std::pair<std::string, std::vector<Results>>> pages{
        {"one film",
         {film(1, "a film with a name that is far longer than any screen is wide, 4.5 g, run 12")}},
        {"two runs", {film(1, "tracked"), film(2, "true positions")}},
        {"heights", {film_in_space(1, "tracked"), film_in_space(2, "true positions")}},
        {"critical point",
         {critical_point(), film(1, "Γ = 3.5"), film(2, "Γ = 4"), film(3, "Γ = 4.5")}},
    };
    for (const auto& [name, runs] : pages) {
        for (const bool paper : {false, true}) {
            const auto file = page(runs, paper);
            for (const auto& [width, height] : {std::pair(1366, 768), std::pair(390, 844)}) {
                browser_->open_page(file, width, height);
                EXPECT_EQ(browser_->evaluate("innerWidth"), width)
                    << "the screen that was asked for";
                EXPECT_EQ(browser_->evaluate(too_wide), "")
                    << name << (paper ? ", paper" : "") << " at " << width;
                // Unfolded, tables are wider.
                browser_->evaluate(
                    "document.querySelectorAll('details').forEach((d) => { d.open = true; })");
                EXPECT_EQ(browser_->evaluate(too_wide), "") << name << ", unfolded, at " << width;
                EXPECT_EQ(browser_->evaluate("document.documentElement.dataset.errors ?? ''"), "");
            }
        }
    }
}

TEST_F(PageOnScreens, OpensEveryPictureWhollyInSight) {
    std::vector<Results> runs{film(1, "first"), film(2, "second"), film(3, "flat"),
                              film(4, "tall")};
    for (Preview& preview : runs[2].previews) {
        preview.snapshot.box.length.x *= 2.5;
        preview.frame.image = {};
    }
    for (Preview& preview : runs[3].previews) {
        preview.snapshot.box.length.y *= 2.5;
        preview.frame.image = {};
    }
    const auto file = page(runs);
    for (const auto& [width, height] : {std::pair(1366, 768), std::pair(390, 844)}) {
        browser_->open_page(file, width, height);
        // The first run beside each.
        EXPECT_EQ(browser_->evaluate(R"JS((async () => {
            const boxes = [...document.querySelectorAll("#map .view")];
            const maps = JSON.parse(document.getElementById("report-data").textContent).maps;
            const fault = (plot, map) => {
                const { xaxis, yaxis } = plot._fullLayout;
                const holds = (axis, [low, high]) => Math.min(...axis.range) <= low + 1e-6
                    && Math.max(...axis.range) >= high - 1e-6;
                const area = plot.getBoundingClientRect();
                if (!holds(xaxis, map.x)) return `x cut: ${xaxis.range} of ${map.x}`;
                if (!holds(yaxis, map.y)) return `y cut: ${yaxis.range} of ${map.y}`;
                if (Math.abs(Math.abs(xaxis._m / yaxis._m) - 1) > 1e-6) return "x and y on unlike scales";
                return area.right <= innerWidth && xaxis._offset + xaxis._length <= area.width ? "" : "too wide";
            };
            const faults = [];
            for (let run = 0; run < 4; run++) {
                const pick = boxes[1].querySelector(".pick-run");
                pick.value = String(run);
                pick.dispatchEvent(new Event("change"));
                await new Promise((done) => setTimeout(done, 400));
                boxes.forEach((box, v) => {
                    const why = fault(box.querySelector(".plot"), maps.find((m) => m.run === (v ? run : 0)));
                    if (why) faults.push(`view ${v} beside run ${run}: ${why}`);
                });
            }
            return faults.join("; ");
        })())JS"),
                  "")
            << "at " << width;
    }
}

TEST_F(PageOnScreens, GivesPicturesOfUnlikeShapeTheWidthThatTheyFill) {
    std::vector<Results> runs{film(1, "square"), film(2, "flat")};
    for (Preview& preview : runs[1].previews) {
        preview.snapshot.box.length.y *= 0.25;
        preview.frame.image = {};
    }
    browser_->open_page(page(runs), 1366, 768);
    // As wide in diameters as the square one: it opens across its panel, not as a stamp within it.
    // The square one is as high as its panel, which may be wider.
    EXPECT_EQ(
        browser_->evaluate(R"JS([...document.querySelectorAll("#map .view")].map((box, run) => {
        const map = JSON.parse(document.getElementById("report-data").textContent).maps.find((m) => m.run === run);
        const { xaxis, yaxis } = box.querySelector(".plot")._fullLayout;
        const filled = (range, axis) => (range[1] - range[0]) / Math.abs(axis.range[1] - axis.range[0]);
        const most = Math.max(filled(map.x, xaxis), filled(map.y, yaxis));
        return most > 0.8 ? "" : `view ${run} fills ${most}`;
    }).join(""))JS"),
        "");
}

// Centre [diameters] and scale [CSS pixels a diameter] of both pictures.
constexpr const char* windows =
    R"JS([...document.querySelectorAll("#map .view")].map((box, run) => {
    const map = JSON.parse(document.getElementById("report-data").textContent).maps.find((m) => m.run === run);
    const { xaxis, yaxis } = box.querySelector(".plot")._fullLayout;
    const middle = (range) => (range[0] + range[1]) / 2;
    return [middle(xaxis.range) / map.diameter, middle(yaxis.range) / map.diameter,
        xaxis._length * map.diameter / Math.abs(xaxis.range[1] - xaxis.range[0])];
}))JS";

TEST_F(PageOnScreens, KeepsTheZoomOfBothPicturesWhenTheFrameChanges) {
    std::vector<Results> runs{film(1, "three frames"), film(2, "one frame")};
    runs[1].previews.resize(1);  // goes with every frame of the other
    browser_->open_page(page(runs), 1366, 768);
    const json whole = browser_->evaluate(windows);
    for (int i = 0; i < 3; ++i) {
        browser_->evaluate("document.querySelector('#map .zoom button').click()");
        browser_->evaluate("new Promise((done) => setTimeout(done, 300))");
    }
    const json zoomed = browser_->evaluate(windows);
    EXPECT_GT(zoomed[0][2].get<double>(), 2 * whole[0][2].get<double>());
    EXPECT_NEAR(zoomed[0][2].get<double>(), zoomed[1][2].get<double>(), 1e-6);
    for (const char* frame : {"1", "2", "0"}) {
        browser_->evaluate(std::string("(() => { const s = document.querySelector('.pick-frame'); "
                                       "s.value = '") +
                           frame + "'; s.dispatchEvent(new Event('input')); })()");
        browser_->evaluate("new Promise((done) => setTimeout(done, 400))");
        const json now = browser_->evaluate(windows);
        for (std::size_t view = 0; view < 2; ++view) {
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_NEAR(now[view][i].get<double>(), zoomed[view][i].get<double>(), 1e-6)
                    << "view " << view << ", frame " << frame << ", " << i;
            }
        }
    }
    browser_->evaluate("document.querySelector('#map .zoom button[value=\"0\"]').click()");
    browser_->evaluate("new Promise((done) => setTimeout(done, 400))");
    EXPECT_NEAR(browser_->evaluate(windows)[1][2].get<double>(), whole[1][2].get<double>(), 1e-6);
    EXPECT_EQ(browser_->evaluate("document.documentElement.dataset.errors ?? ''"), "");
}

TEST_F(PageOnScreens, RepaintsWithoutLookingAnythingUpAgain) {
    browser_->open_page(page({film(1, "first"), film(2, "second")}), 1366, 768);
    const json counts = browser_->evaluate(R"JS((async () => {
        const wait = () => new Promise((done) => setTimeout(done, 400));
        const slider = document.querySelector(".pick-frame");
        slider.value = "2";
        slider.dispatchEvent(new Event("input"));
        await wait();
        document.querySelector(".trails").click();
        await wait();
        const closer = document.querySelector("#map .zoom button");
        const lookUp = Element.prototype.querySelector;
        const Plain = window.Map;
        let places = 0, identities = 0, paintings = 0;
        Element.prototype.querySelector = function (text) {
            places += text.startsWith(".place");
            return lookUp.call(this, text);
        };
        window.Map = class extends Plain {
            constructor(entries) {
                super(entries);
                identities += entries !== undefined && entries.length > 100;
            }
        };
        const clear = CanvasRenderingContext2D.prototype.clearRect;
        CanvasRenderingContext2D.prototype.clearRect = function (...area) {
            paintings++;
            return clear.apply(this, area);
        };
        closer.click();
        await wait();
        return [paintings, places, identities];
    })())JS");
    EXPECT_GE(counts[0], 2) << "both pictures";
    EXPECT_EQ(counts[1], 0) << "buttons of places";
    EXPECT_EQ(counts[2], 0) << "identities of frames";
    EXPECT_THAT(browser_->evaluate("document.querySelector('.trails').title").get<std::string>(),
                testing::HasSubstr("over 3 a"));
    EXPECT_EQ(browser_->evaluate("document.documentElement.dataset.errors ?? ''"), "");
}

TEST_F(PageOnScreens, FillsAWindowThatGrows) {
    browser_->open_page(page({film(1, "first"), film(2, "second")}), 1000, 560);
    const char* share = R"JS((async () => {
        await new Promise((done) => setTimeout(done, 800));
        return [...document.querySelectorAll("#map .plot")].map((plot) => {
            const { xaxis, yaxis } = plot._fullLayout;
            const part = (axis) => 300 * axis._m / axis._length;
            return Math.max(Math.abs(part(xaxis)), Math.abs(part(yaxis))).toFixed(2);
        }).join(" ");
    })())JS";
    const json before = browser_->evaluate(share);
    browser_->resize(1600, 1100);
    EXPECT_EQ(browser_->evaluate(share), before) << "pictures fill their plots as before";
    EXPECT_EQ(before, "1.00 1.00");
}

TEST_F(PageOnScreens, NarrowsPicturesWithTheWindow) {
    const char* right = R"JS((async () => {
        await new Promise((done) => setTimeout(done, 800));
        return Math.max(...[...document.querySelectorAll("#map .main-svg, #map canvas:not(.lens)")]
            .map((e) => e.getBoundingClientRect().right));
    })())JS";
    browser_->open_page(page({film(1, "first")}), 1366, 768);
    for (const int width : {1000, 600, 390}) {
        browser_->resize(width, 844);
        EXPECT_LE(browser_->evaluate(right).get<double>(), width);
    }
}

TEST_F(PageOnScreens, ShowsTheCriticalPointBeforeAnyScrolling) {
    browser_->open_page(page({critical_point(), film(1, "Γ = 3.5"), film(2, "Γ = 4")}), 1366, 768);
    for (const char* plot : {"plot-critical", "plot-critical_epsilon"}) {
        const std::string bottom =
            std::string("document.getElementById('") + plot + "').getBoundingClientRect().bottom";
        EXPECT_LE(browser_->evaluate(bottom).get<double>(), 768) << plot;
    }
}

TEST_F(PageOnScreens, OpensThePaperWithItsOwnFiguresInItsOwnArrangement) {
    Results tracked = film(1, "tracked, Γ = 4.5");
    tracked.identity.control = ControlValue{ControlParameter::acceleration, 4.5};
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s1", "-", 0.09, 0.01, 5, ""}};
    tracked.observables.push_back(fit);
    std::vector<Results> runs{tracked, critical_point()};
    runs[1].identity.origin = Origin::video;
    for (std::uint64_t i = 2; i < 8; ++i) runs.push_back(film(i, "run " + std::to_string(i)));
    const auto file = page(runs, true);
    const std::string box =
        "const box = (n) => document.querySelector(`[data-panel=\"${n}\"]`)"
        ".getBoundingClientRect();";
    browser_->open_page(file, 1366, 768);
    EXPECT_EQ(browser_->evaluate("(() => {" + box + R"JS(
        const wrong = [];
        for (const row of ["abc", "def", "ghi"]) {
            const boxes = [...row].map((c) => box("2" + c));
            if (!(boxes[0].right <= boxes[1].left && boxes[1].right <= boxes[2].left)) wrong.push("columns of " + row);
            if (new Set(boxes.map((b) => b.top)).size !== 1) wrong.push("row " + row);
        }
        const tops = ["1b map", "2a", "2d", "2g", "3"].map((n) => box(n).top);
        if (tops.some((top, i) => i && top <= tops[i - 1])) wrong.push("order");
        if (box("1b map").bottom > 768) wrong.push("the map on the first screen");
        const after = [".pictures", ".tables", "#warnings"].map((s) => document.querySelector(s).getBoundingClientRect().top);
        if (after.some((top, i) => top <= (i ? after[i - 1] : box("4b").top))) wrong.push("after the figures");
        return wrong.join(", ");
    })())JS"),
              "");
    // The paper's numbers are drawn: a filled band about 4.73 where ours is 4.7, lines in |Q4|.
    EXPECT_EQ(browser_->evaluate(R"JS(document.getElementById("plot-paper_2b").data
                  .filter((t) => t.fill === "toself" && t.name.includes("4.73")).length)JS"),
              1);
    EXPECT_EQ(browser_->evaluate(R"JS(document.getElementById("plot-paper_1b").data
                  .filter((t) => t.name.startsWith("paper: ")).length)JS"),
              3);
    EXPECT_GT(browser_->evaluate("document.querySelectorAll('.paper .map svg path').length"), 10)
        << "discs in the colours of their |Q4|";
    EXPECT_EQ(browser_->evaluate("document.querySelectorAll('#warnings > ul > li').length"), 1)
        << "one line a kind";
    EXPECT_EQ(browser_->evaluate("document.documentElement.dataset.errors ?? ''"), "");
    browser_->open_page(file, 390, 844);
    EXPECT_EQ(browser_->evaluate("(() => {" + box + R"JS(
        return box("2a").left === box("2b").left && box("2a").bottom <= box("2b").top;
    })())JS"),
              true)
        << "one below the other on a telephone";
    EXPECT_EQ(browser_->evaluate(too_wide), "");
}

TEST_F(PageOnScreens, ReachesEveryControlWithTabAndShowsWhereItIs) {
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

TEST_F(PageOnScreens, DoesWithKeysWhatAPointerDoes) {
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

// A number that changes with the picture on a canvas; 0: nothing is drawn.
std::string picture_of(const std::string& canvas) {
    return "(async () => { await new Promise((done) => setTimeout(done, 300)); const c = "
           "document.querySelector('" +
           canvas +
           "'); return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.reduce((sum, "
           "v, i) => (sum * 31 + v * (1 + i % 7)) % 1000003, 0); })()";
}

TEST_F(PageOnScreens, TurnsAPatchInSpaceByDraggingAndByKeys) {
    browser_->open_page(page({film_in_space(1, "layer")}), 1366, 768);
    const std::string patch = picture_of(".space canvas.patch");
    const auto angles = [&] {
        return browser_->evaluate("document.querySelector('.patch-view .state').textContent")
            .get<std::string>();
    };
    browser_->evaluate("document.querySelector('canvas.patch').scrollIntoView({block: 'center'})");
    const json first = browser_->evaluate(patch);
    EXPECT_NE(first, 0);
    EXPECT_NE(browser_->evaluate(picture_of(".space canvas.side")), 0);
    EXPECT_THAT(angles(), testing::StartsWith("Turned by 30°, seen from 35°"));
    const json box = browser_->evaluate(
        "(() => { const b = document.querySelector('canvas.patch').getBoundingClientRect(); return "
        "[(b.left + b.right) / 2, (b.top + b.bottom) / 2]; })()");
    const double x = box[0].get<double>();
    const double y = box[1].get<double>();
    browser_->drag(x, y, x + 60, y - 20);
    const json turned = browser_->evaluate(patch);
    EXPECT_NE(turned, first);
    EXPECT_THAT(angles(), testing::StartsWith("Turned by 60°, seen from 25°"));
    browser_->evaluate("document.querySelector('canvas.patch').focus()");
    browser_->press("ArrowRight");
    EXPECT_NE(browser_->evaluate(patch), turned);
    EXPECT_THAT(angles(), testing::StartsWith("Turned by 65°, seen from 25°"));
    browser_->evaluate(
        "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {key: '0'}))");
    EXPECT_EQ(browser_->evaluate(patch), first);
    EXPECT_EQ(browser_->evaluate("document.documentElement.dataset.errors ?? ''"), "");
}

TEST_F(PageOnScreens, ShowsFromTheSideWhatIsChosenInTheMap) {
    browser_->open_page(page({film_in_space(1, "layer"), film(2, "no heights")}), 1366, 768);
    const std::string side = picture_of(".space canvas.side");
    const json first = browser_->evaluate(side);
    EXPECT_EQ(
        browser_->evaluate("[...document.querySelectorAll('.side-view, .patch-view')].map((f) "
                           "=> f.hidden)"),
        json({false, true, false, true}))
        << "the other run has no heights";
    EXPECT_THAT(
        browser_->evaluate("document.querySelector('.side-view .state').textContent").dump(),
        testing::ContainsRegex("[0-9]+ spheres, the height of [0-9]+ uncertain .dashed."));
    EXPECT_EQ(browser_->evaluate("document.querySelector('.space .doubtful').hidden"), false);
    // A click in the map, a quarter from its upper edge.
    const json at = browser_->evaluate(
        "(() => { const b = document.querySelector('#map .plot').getBoundingClientRect(); return "
        "[(b.left + b.right) / 2, b.top + b.height / 4]; })()");
    browser_->drag(at[0], at[1], at[0], at[1]);
    const json moved = browser_->evaluate(side);
    EXPECT_NE(moved, first);
    EXPECT_THAT(browser_->evaluate("document.querySelector('.across + output').textContent").dump(),
                testing::HasSubstr("a above the middle"));
    EXPECT_LT(browser_->evaluate("Number(document.querySelector('.across').value)"), -4);
    browser_->evaluate(
        "(() => { const s = document.querySelector('.across'); s.value = '0'; s.dispatchEvent(new "
        "Event('input')); const u = document.querySelector('.along'); u.value = '0'; "
        "u.dispatchEvent(new Event('input')); })()");
    EXPECT_EQ(browser_->evaluate(side), first) << "the middle again";
    // The lens by its keys.
    browser_->evaluate("document.querySelector('#map .stage').focus()");
    for (int i = 0; i < 6; ++i) browser_->press("ArrowRight");
    browser_->press("Enter");
    EXPECT_GT(browser_->evaluate("Number(document.querySelector('.along').value)"), 0.5);
    // Colours are those of the map.
    browser_->evaluate(
        "(() => { const c = document.querySelector('.pick-colour'); c.value = 'layer'; "
        "c.dispatchEvent(new Event('change')); })()");
    EXPECT_NE(browser_->evaluate(side), first);
    EXPECT_EQ(browser_->evaluate("document.documentElement.dataset.errors ?? ''"), "");
}

TEST_F(PageOnScreens, CopiesSettingsAndGoesToMarkedSpheres) {
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

TEST_F(PageOnScreens, SlidersShowWhatOtherSettingsFindAndTheSettings) {
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

TEST_F(PageOnScreens, IsReadInGrey) {
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
