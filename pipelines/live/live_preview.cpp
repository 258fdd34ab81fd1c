#include "pipelines/live/live_preview.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "analysis/order/bond_order.h"
#include "core/errors.h"
#include "io/video/colour_video.h"
#include "pipelines/job.h"
#include "report/maps/overlay.h"
#include "report/maps/png.h"

namespace grainfield::pipelines {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds between_pictures{1};

bool is_jpeg(const std::filesystem::path& file) {
    return file.extension() == ".jpg" || file.extension() == ".jpeg";
}

std::string caption_of(const Snapshot& found, const std::vector<double>& q4, bool has_times,
                       std::int64_t dropped) {
    double sum = 0;
    std::int64_t defined = 0;
    for (const double q : q4) {
        if (!std::isfinite(q)) continue;
        sum += q;
        ++defined;
    }
    std::string text = fmt::format("frame {}", found.frame);
    if (has_times) text += fmt::format("  {:.2f} s", found.time);
    text += "  " + counted(static_cast<std::int64_t>(found.size()), "sphere");
    if (defined > 0) text += fmt::format("  mean |Q4| {:.3f}", sum / static_cast<double>(defined));
    if (dropped > 0) text += fmt::format("  {} dropped", dropped);
    return text;
}

}  // namespace

void require_preview_name(const std::filesystem::path& file) {
    if (file.extension() == ".png" || is_jpeg(file)) return;
    throw OptionError({.problem = fmt::format("cannot write the preview '{}'", file.string()),
                       .actual = {},
                       .expected = "a name that ends in .png or .jpg",
                       .suggestion = fmt::format(
                           "for example --preview {}",
                           std::filesystem::path(file).replace_extension(".png").string())});
}

LivePreview::LivePreview(std::filesystem::path file, Overwrite overwrite, double diameter,
                         bool has_times)
    : file_(std::move(file)), overwrite_(overwrite), diameter_(diameter), has_times_(has_times) {
    require_preview_name(file_);
    const OutputFile refuse_now(file_, overwrite_);
}

bool LivePreview::is_due() const {
    if (!shown_) return true;
    return Clock::now() - *shown_ >= between_pictures &&
           drawing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void LivePreview::show(Frame frame, Snapshot found, std::int64_t dropped) {
    finish();
    shown_ = Clock::now();
    drawing_ = std::async(
        std::launch::async, [this, dropped, overwrite = std::exchange(overwrite_, Overwrite::force),
                             frame = std::move(frame), found = std::move(found)] {
            report::OverlayOptions options;
            options.trail = 0;
            options.diameter = diameter_;
            options.width = frame.image.width();
            options.height = frame.image.height();
            options.x = {-0.5, options.width - 0.5};
            options.y = {-0.5, options.height - 0.5};
            options.has_strip = true;
            report::Overlay overlay(options);
            const std::vector<double> q4 = analysis::abs_q4(found, diameter_, {});
            const std::vector<std::uint8_t>& rgb =
                overlay.draw(frame.image, found, q4, caption_of(found, q4, has_times_, dropped));
            if (is_jpeg(file_)) {
                io::write_jpeg(file_, rgb, overlay.width(), overlay.height(), overwrite);
                return;
            }
            const std::vector<std::uint8_t> png =
                report::encode_png(rgb, overlay.width(), overlay.height());
            // The bytes of a picture as text, which write_file takes.
            write_file(file_,
                       {reinterpret_cast<const char*>(png.data()),  // NOLINT(*-reinterpret-cast)
                        png.size()},
                       overwrite);
        });
}

void LivePreview::finish() {
    if (drawing_.valid()) drawing_.get();
}

}  // namespace grainfield::pipelines
