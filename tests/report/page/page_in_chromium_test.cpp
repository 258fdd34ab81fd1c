// The page in a real browser: headless Chromium draws it and prints the document that results.

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "report/report.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string output_of(const std::string& command) {
    std::FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    std::array<char, 1 << 16> part{};
    for (std::size_t n = 0; (n = std::fread(part.data(), 1, part.size(), pipe)) > 0;) {
        text.append(part.data(), n);
    }
    pclose(pipe);
    return text;
}

std::string chromium() {
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
        const std::string path = output_of(std::string("command -v ") + name);
        if (!path.empty()) return name;
    }
    return "";
}

// The document after its scripts and `script` have run, without the texts of the scripts. `early`
// runs before them.
std::string drawn(const sample::TemporaryFolder& folder, const std::vector<Results>& runs,
                  const std::string& title, const std::string& window = "1280,900",
                  const std::string& script = "", const std::string& early = "") {
    RunPlan plan;
    write_report(runs, {.title = title, .figures = false, .hints = analysis::figure_hints()},
                 folder / "report.html", folder / "figures", plan);
    if (!script.empty() || !early.empty()) {
        // The page runs its own scripts only.
        std::ifstream written(folder / "report.html", std::ios::binary);
        const std::string page{std::istreambuf_iterator<char>(written), {}};
        written.close();
        const auto policy = page.find("<meta http-equiv=\"Content-Security-Policy\"");
        const auto after_policy = page.find('>', policy) + 1;
        const auto data = page.find("<script type=\"application/json\"");
        std::ofstream file(folder / "report.html", std::ios::binary);
        file << page.substr(0, policy) << page.substr(after_policy, data - after_policy)
             << "<script>" << early << "</script>" << page.substr(data) << "<script>" << script
             << "</script>";
    }
    std::string dom =
        output_of("timeout 120 " + chromium() +
                  " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run "
                  "--disable-background-networking --disable-component-update --disable-sync "
                  "--user-data-dir='" +
                  (folder / "profile").string() + "' --window-size=" + window +
                  " --virtual-time-budget=20000 --dump-dom 'file://" +
                  (folder / "report.html").string() + "' 2>/dev/null");
    for (auto from = dom.find("<script"); from != std::string::npos; from = dom.find("<script")) {
        dom.erase(from, dom.find("</script>", from) + 9 - from);
    }
    return dom;
}

std::ptrdiff_t count(const std::string& text, const char* pattern) {
    const std::regex expression(pattern);
    return std::distance(std::sregex_iterator(text.begin(), text.end(), expression), {});
}

class PageInChromium : public testing::Test {
 protected:
    void SetUp() override {
        if (chromium().empty())
            GTEST_SKIP() << "no Chromium here (Debian: apt-get install chromium)";
    }
};

TEST_F(PageInChromium, DrawsEveryPlotWithoutError) {
    const sample::TemporaryFolder folder("chromium_plots");
    const std::string dom = drawn(folder, {sample::results()}, "A report");
    EXPECT_THAT(dom, HasSubstr("data-ready=\"6\"")) << "five figures and the map";
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    EXPECT_EQ(count(dom, "class=\"[^\"]*js-plotly-plot"), 6);
    EXPECT_GE(count(dom, "class=\"errorbars\""), 2) << "S(k) and the variance have error bars";
    EXPECT_THAT(dom, HasSubstr("Linear axes"));
}

TEST_F(PageInChromium, ComparesRunsAndShowsReasons) {
    const sample::TemporaryFolder folder("chromium_compare");
    const std::vector<Results> runs{sample::results({1, 300, 80, true, "first"}),
                                    sample::results({2, 300, 80, false, "second"})};
    const std::string dom = drawn(folder, runs, "", "500,900");
    EXPECT_THAT(dom, HasSubstr("data-ready=\"7\"")) << "five figures and two pictures";
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    EXPECT_THAT(dom, HasSubstr("Without second: one frame: displacements need two"));
}

TEST_F(PageInChromium, LooksAtTheSamePartOfBothRunsWhicheverIsMoved) {
    const sample::TemporaryFolder folder("chromium_linked");
    std::vector<Results> runs{sample::results({1, 300, 80, true, "first"}),
                              sample::results({2, 300, 80, true, "second"})};
    // Other pixels a sphere: the same part of the layer has twice as many of them.
    runs[1].source.diameter *= 2;
    for (Preview& preview : runs[1].previews) {
        preview.snapshot.box.length = {600, 600};
        preview.frame.image = {};
        for (Vec2& p : preview.snapshot.position) p = 2 * p + Vec2{0.5, 0.5};
    }
    const std::string dom = drawn(folder, runs, "", "1280,900", R"(
        setTimeout(async () => {
            const plots = [...document.querySelectorAll("#map .plot")];
            // Centre, and pixels of the screen a diameter.
            const ranges = () => plots.map((p, i) => {
                const { range, _length } = p._fullLayout.xaxis;
                return Math.round((range[0] + range[1]) / 2) + ":" +
                    (_length / (range[1] - range[0]) * (i ? 2 : 1)).toFixed(1);
            });
            await Plotly.relayout(plots[0], {"xaxis.range": [99.5, 199.5], "yaxis.range": [199.5, 99.5]});
            await new Promise((done) => setTimeout(done, 300));
            document.body.dataset.first = ranges().join(" ");
            document.body.dataset.height = plots[0]._fullLayout.yaxis.range.map(Math.round).join(":");
            await Plotly.relayout(plots[1], {"xaxis.range": [199.5, 299.5], "yaxis.range": [299.5, 199.5]});
            await new Promise((done) => setTimeout(done, 300));
            document.body.dataset.second = ranges().join(" ");
        }, 12000);)");
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    EXPECT_EQ(count(dom, "data-height=\"(199|200):(99|100)\""), 1)
        << dom.substr(dom.find("data-height"), 60);
    EXPECT_EQ(count(dom, "data-first=\"(149|150):([0-9.]+) (299|300):\\2\""), 1)
        << dom.substr(dom.find("data-first"), 60);
    EXPECT_EQ(count(dom, "data-second=\"(124|125):([0-9.]+) (249|250):\\2\""), 1)
        << dom.substr(dom.find("data-second"), 60);
}

TEST_F(PageInChromium, OpensPicturesOfUnlikeShapeOnOneScaleOfLengths) {
    const sample::TemporaryFolder folder("chromium_shapes");
    std::vector<Results> runs{sample::results({1, 300, 80, true, "square"}),
                              sample::results({2, 300, 80, true, "long"})};
    for (Preview& preview : runs[1].previews) {
        preview.snapshot.box.length.x *= 2.5;
        preview.frame.image = {};
    }
    const std::string dom = drawn(folder, runs, "", "1280,900", R"(
        setTimeout(async () => {
            const plots = [...document.querySelectorAll("#map .plot")];
            const scales = () => plots.map((p) => {
                const { range, _length } = p._fullLayout.xaxis;
                return _length / (range[1] - range[0]);
            });
            const ratio = () => { const [a, b] = scales(); return (a / b).toFixed(2); };
            document.body.dataset.opened = ratio();
            document.querySelector("#map .zoom button[value='0.5'], #map .zoom button").click();
            await new Promise((done) => setTimeout(done, 500));
            document.body.dataset.zoomed = ratio();
            document.querySelector("#map .zoom button[value='0']").click();
            await new Promise((done) => setTimeout(done, 500));
            document.body.dataset.back = ratio();
        }, 12000);)");
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    for (const char* fact :
         {"data-opened=\"1.00\"", "data-zoomed=\"1.00\"", "data-back=\"1.00\""}) {
        EXPECT_THAT(dom, HasSubstr(fact)) << dom.substr(dom.find("<body"), 300);
    }
}

TEST_F(PageInChromium, HasALensAndAllControlsOnTheKeyboardAndFitsANarrowScreen) {
    const sample::TemporaryFolder folder("chromium_keyboard");
    std::vector<Results> runs{sample::results({1, 300, 80, true, "layer"})};
    Snapshot& snapshot = runs[0].previews[0].snapshot;
    snapshot.quality.assign(snapshot.size(), 0.03);
    snapshot.quality[7] = 0.5;
    for (ObservableResult& observable : runs[0].observables) {
        if (observable.name != "sk") continue;
        Curve map{
            "sk_map", "", {{"kx", "1/a", "", {}}, {"ky", "1/a", "", {}}, {"s", "-", "", {}}}, {}};
        for (int i = 1; i < 16; ++i) {
            map.columns[0].values.push_back(0.1 * (i / 4));
            map.columns[1].values.push_back(0.1 * (i % 4));
            map.columns[2].values.push_back(0.01 * i);
        }
        observable.curves.push_back(map);
    }
    const std::string dom = drawn(folder, runs, "", "1366,768", R"(
        setTimeout(async () => {
            const wait = () => new Promise((done) => setTimeout(done, 300));
            const stage = document.querySelector("#map .stage");
            const lens = document.querySelector("#map .lens");
            const press = (key) =>
                stage.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, cancelable: true}));
            const axis = () => stage.querySelector(".plot")._fullLayout.xaxis;
            const whole = axis()._length;
            // What the whole plot would show at this scale.
            const width = () => (axis().range[1] - axis().range[0]) * whole / axis()._length;
            const data = document.body.dataset;
            data.screen = document.querySelector(".cards").getBoundingClientRect().bottom <= 768
                && document.querySelector("#map .pick-frame").getBoundingClientRect().bottom <= 768
                && stage.getBoundingClientRect().bottom <= 768;
            stage.focus();
            const all = width();
            press("ArrowRight");
            data.lens = `${!lens.hidden} ${lens.getBoundingClientRect().width}`;
            press("+");
            await wait();
            data.closer = (width() / all).toFixed(2);
            press("0");
            await wait();
            data.whole = (width() / all).toFixed(2);
            press("Escape");
            data.gone = lens.hidden;
            document.querySelector(".place").click();
            await wait();
            const tall = stage.querySelector(".plot")._fullLayout.yaxis.range;
            const shown = [axis().range, tall].map(([from, to]) => Math.abs(to - from));
            data.place = (Math.min(...shown) / 10.09).toFixed(0);
            const term = document.querySelector(".term");
            term.focus();
            data.meaning = getComputedStyle(term.querySelector(".meaning")).display;
            document.body.style.width = "390px";
            window.dispatchEvent(new Event("resize"));
            await wait();
            const wide = [...document.querySelectorAll("main *")].filter((e) =>
                !e.closest(".scroll, .plot, .meaning, .js-plotly-plot") && e.getBoundingClientRect().right > 391);
            data.wide = wide.map((e) => e.tagName + "." + e.className).join(" ");
            data.maps = document.querySelectorAll(".spectrum-map svg").length;
        }, 10000);)");
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    for (const char* fact :
         {"data-screen=\"true\"", "data-lens=\"true 150\"", "data-closer=\"0.80\"",
          "data-whole=\"1.00\"", "data-gone=\"true\"", "data-place=\"14\"",
          "data-meaning=\"block\"", "data-wide=\"\"", "data-maps=\"1\"", "1 place to look at"}) {
        EXPECT_THAT(dom, HasSubstr(fact)) << dom.substr(dom.find("<body"), 400);
    }
}

TEST_F(PageInChromium, ShowsThePictureInTheGalleryWhereNothingWasFound) {
    const sample::TemporaryFolder folder("chromium_gallery");
    std::vector<Results> runs{sample::results({1, 300, 80, true, "found"}),
                              sample::results({2, 300, 80, true, "residual"}),
                              sample::results({3, 300, 80, true, "third"})};
    runs[1].previews[0].snapshot.position.clear();
    runs[1].previews[0].abs_q4.clear();
    // How many shades the red of each small map has.
    const std::string dom = drawn(folder, runs, "", "1280,900",
                                  R"(setTimeout(() => {
        document.body.dataset.shades = [...document.querySelectorAll(".gallery canvas")].map((c) => {
            const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
            return new Set(d.filter((v, i) => i % 4 === 0)).size;
        }).join(" ");
    }, 15000);)");
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    EXPECT_EQ(count(dom, "data-shades=\"[0-9]{2,3} [0-9]{2,3} [0-9]{2,3}\""), 1)
        << dom.substr(dom.find("data-shades"), 40);
}

TEST_F(PageInChromium, ShowsThePictureOfARunThatIsChosenBeforeItIsRead) {
    const std::vector<Results> runs{sample::results({1, 120, 40, true, "A"}),
                                    sample::results({2, 120, 40, true, "B"}),
                                    sample::results({3, 120, 40, true, "C"})};
    const std::string choose = R"JS(
        const choice = document.querySelector("#map .pick-run");
        choice.value = "2";
        choice.dispatchEvent(new Event("change"));)JS";
    const std::string look = R"JS(
        setTimeout(() => {
            const canvas = document.querySelector("#map .stage canvas");
            const all = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
            let drawn = 0;
            for (let i = 3; i < all.length; i += 4) drawn += all[i] === 255;
            document.body.dataset.drawn = String(drawn / (all.length / 4) > 0.3);
        }, 3000);)JS";
    // As soon as the page is there, and by the browser that loads it again.
    for (const bool again : {false, true}) {
        const sample::TemporaryFolder folder("chromium_following");
        const std::string dom =
            drawn(folder, runs, "", "1400,900", again ? look : choose + look, again ? choose : "");
        EXPECT_THAT(dom, HasSubstr("data-drawn=\"true\"")) << again;
        EXPECT_THAT(dom, Not(HasSubstr("data-errors"))) << again;
    }
}

TEST_F(PageInChromium, DrawsEachParticleForEveryMarkAndColour) {
    const sample::TemporaryFolder folder("chromium_marks");
    std::vector<Results> runs{sample::results({1, 400, 100, true, "layer"})};
    Snapshot& snapshot = runs[0].previews[0].snapshot;
    snapshot.layer.clear();
    snapshot.id.clear();
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        snapshot.layer.push_back(i % 3 == 0 ? Layer::top : Layer::bottom);
        snapshot.id.push_back(static_cast<std::int64_t>(i));
    }
    // What the canvas of the map is told to draw at each choice; the clip of the frame is one
    // rectangle.
    const std::string dom = drawn(folder, runs, "", "1280,900", R"(
        let drawn = 0;
        for (const shape of ["arc", "rect"]) {
            const plain = CanvasRenderingContext2D.prototype[shape];
            CanvasRenderingContext2D.prototype[shape] = function (...where) {
                if (this.canvas.closest("#map .stage")) ++drawn;
                return plain.apply(this, where);
            };
        }
        const inks = new Set();
        const stroke = CanvasRenderingContext2D.prototype.stroke;
        CanvasRenderingContext2D.prototype.stroke = function (...path) {
            if (this.canvas.closest("#map .stage")) inks.add(this.strokeStyle);
            return stroke.apply(this, path);
        };
        setTimeout(() => {
            const colours = document.querySelector("#map .pick-colour");
            document.querySelector('#map .kinds button[value="outlines"]').click();
            document.body.dataset.inks = String(inks.size);
            document.body.dataset.bar = String(!document.querySelector("#map .colour-bar").hidden);
            const counts = [];
            for (const option of colours.options) {
                for (const button of document.querySelectorAll("#map .kinds button")) {
                    colours.value = option.value;
                    colours.dispatchEvent(new Event("change"));
                    drawn = 0;
                    button.click();
                    counts.push(option.value + "/" + button.value + "=" + (drawn - 1));
                }
            }
            document.body.dataset.drawn = counts.join(" ");
        }, 15000);)");
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    EXPECT_EQ(count(dom, "data-inks=\"[0-9]{2,3}\""), 1)
        << "outlines show the order: " << dom.substr(dom.find("data-inks"), 20);
    EXPECT_THAT(dom, HasSubstr("data-bar=\"true\""));
    for (const char* colour : {"order", "identity", "layer"}) {
        for (const char* mark : {"discs", "outlines", "centres"}) {
            EXPECT_THAT(dom, HasSubstr(std::string(colour) + "/" + mark + "=" +
                                       std::to_string(snapshot.size()) + " "))
                << dom.substr(dom.find("data-drawn"), 300);
        }
        EXPECT_THAT(dom, HasSubstr(std::string(colour) + "/none=0"));
    }
}

TEST_F(PageInChromium, DrawsResultsWithNothingInThem) {
    const sample::TemporaryFolder folder("chromium_empty");
    const std::string dom = drawn(folder, {Results{}}, "");
    EXPECT_THAT(dom, HasSubstr("data-ready=\"0\""));
    EXPECT_THAT(dom, Not(HasSubstr("data-errors")));
    EXPECT_EQ(count(dom, "class=\"absent\">No picture"), 1);
    EXPECT_EQ(count(dom, "<figure"), 0) << "no panel for what is not there";
}

TEST_F(PageInChromium, DoesNotRunWhatNamesContain) {
    const sample::TemporaryFolder folder("chromium_hostile");
    const std::string hostile =
        "</script><script>document.title='pwned'</script>"
        "<img src=x onerror=\"document.title='pwned'\"><a href='javascript:alert(1)'>x</a>";
    std::vector<Results> runs{sample::results({1, 300, 80, true, hostile}),
                              sample::results({2, 300, 80, true, "%{x} <b>bold</b>"})};
    for (Results& run : runs) {
        run.record.inputs[0].name = hostile;
        run.record.configuration = {{hostile, hostile}};
        run.record.warnings = {{.text = hostile}};
        run.source.source = hostile;
        for (ObservableResult& observable : run.observables) {
            for (Measurement& m : observable.measurements) m.unit = hostile, m.reason = hostile;
            for (Curve& curve : observable.curves) {
                curve.title = hostile;
                for (Column& column : curve.columns)
                    column.unit = hostile, column.meaning = hostile;
            }
        }
    }
    const std::string dom = drawn(folder, runs, "Plain title");
    EXPECT_THAT(dom, HasSubstr("data-ready=\"7\""));
    EXPECT_THAT(dom, Not(HasSubstr("data-errors"))) << "not even refused by the policy";
    EXPECT_THAT(dom, HasSubstr("<title>Plain title</title>"));
    EXPECT_EQ(count(dom, "<img"), 0);
    EXPECT_EQ(count(dom, "<a [^>]*javascript:"), 0);
    EXPECT_EQ(count(dom, "<b>bold"), 0);
}

TEST_F(PageInChromium, OffersNoUpload) {
    const sample::TemporaryFolder folder("chromium_upload");
    const std::string dom = drawn(folder, {sample::results({1, 300, 80, true, "A"})}, "");
    EXPECT_EQ(count(dom, "data-title=\"[^\"]*([Cc]loud|[Ss]hare|[Uu]pload|[Ll]ink)"), 0);
    EXPECT_GT(count(dom, "data-title=\"Zoom\""), 0) << "the tool bar is there";
}

}  // namespace
}  // namespace grainfield::report
