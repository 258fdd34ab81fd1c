#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "report/report.h"
#include "tests/report/page/chromium_session.h"
#include "tests/report/sample_results.h"

/// Runs with all that a page may show, and a browser that opens the page.
namespace grainfield::report {

/// A layer with everything that a film may have: places to look at, identities, layers, frames.
inline Results film(std::uint64_t seed, const std::string& label) {
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

/// The same with heights in two layers, every fifth of them uncertain.
inline Results film_in_space(std::uint64_t seed, const std::string& label) {
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

inline Results critical_point() {
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

/// A page of runs in a browser; skipped where there is no Chromium.
class PageInBrowser : public testing::Test {
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

/// What reaches beyond the right edge without a bar of its own to scroll it by.
inline constexpr const char* too_wide = R"JS((() => {
    const edge = document.documentElement.clientWidth;
    const root = document.scrollingElement;
    if (root.scrollWidth <= edge) return "";
    return `${root.scrollWidth} px of ${edge}: ` + [...document.querySelectorAll("main *")]
        .filter((e) => !e.closest(".scroll *, .plot *, .meaning") && e.getBoundingClientRect().right > edge + 0.5)
        .map((e) => e.tagName + "." + e.className).slice(0, 8).join(" ");
})())JS";

}  // namespace grainfield::report
