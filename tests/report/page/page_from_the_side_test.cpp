// The layer from the side and in space, as the page draws them.

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

using PageFromTheSide = PageInBrowser;

// A number that changes with the picture on a canvas; 0: nothing is drawn.
std::string picture_of(const std::string& canvas) {
    return "(async () => { await new Promise((done) => setTimeout(done, 300)); const c = "
           "document.querySelector('" +
           canvas +
           "'); return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.reduce((sum, "
           "v, i) => (sum * 31 + v * (1 + i % 7)) % 1000003, 0); })()";
}

TEST_F(PageFromTheSide, TurnsAPatchInSpaceByDraggingAndByKeys) {
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

TEST_F(PageFromTheSide, ShowsFromTheSideWhatIsChosenInTheMap) {
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

}  // namespace
}  // namespace grainfield::report
