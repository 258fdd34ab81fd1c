// The page as people meet it: on the screen of a laptop and of a telephone, and within a second.

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

using PageOnScreens = PageInBrowser;

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

}  // namespace
}  // namespace grainfield::report
