// grainfield-capture SOURCE: frames of a V4L2 camera or a GStreamer pipeline on standard output, as
// YUV4MPEG2 of grey counts. `grainfield track --live` reads them there.
//
// A program of its own: OpenCV's capture brings some two hundred libraries, which no other command
// should load, and a camera that hangs can be ended without the recording.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace {

constexpr int done = 0, bad_usage = 2, bad_source = 3;

/// As a line of the stream: the first, or in the place of a frame, where grainfield looks for it.
int refuse(const std::string& why) {
    std::printf("ERROR %s\n", why.c_str());
    return bad_source;
}

bool is_number(const std::string& text) {
    return !text.empty() &&
           std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Grey formats, the deepest first; else what OpenCV converts to colour.
void choose_grey(cv::VideoCapture& camera) {
    constexpr std::array<const char*, 2> formats{"Y16 ", "GREY"};
    for (const char* name : formats) {
        const double code = cv::VideoWriter::fourcc(name[0], name[1], name[2], name[3]);
        if (camera.set(cv::CAP_PROP_FOURCC, code) && camera.get(cv::CAP_PROP_FOURCC) == code) {
            camera.set(cv::CAP_PROP_CONVERT_RGB, 0);
            return;
        }
    }
}

/// Counts as they are; of colours the luma.
bool to_grey(const cv::Mat& picture, cv::Mat& grey) {
    const bool has_depth = picture.depth() == CV_8U || picture.depth() == CV_16U;
    if (!has_depth || picture.dims != 2) return false;
    if (picture.channels() == 1) {
        grey = picture;
        return true;
    }
    if (picture.channels() != 3) return false;
    cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
    return true;
}

std::string header(const cv::Mat& grey, double rate) {
    const bool is_known = std::isfinite(rate) && rate > 0 && rate < 1e6;
    const auto thousandths = static_cast<std::int64_t>(is_known ? std::llround(1000 * rate) : 0);
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), "YUV4MPEG2 W%d H%d F%lld:%d C%s\n", grey.cols,
                  grey.rows, static_cast<long long>(thousandths), is_known ? 1000 : 0,
                  grey.depth() == CV_16U ? "mono16" : "mono");
    return text.data();
}

bool put(const void* bytes, std::size_t count) {
    return std::fwrite(bytes, 1, count, stdout) == count;
}

bool put(const cv::Mat& grey) {
    if (!put("FRAME\n", 6)) return false;
    for (int y = 0; y < grey.rows; ++y) {
        if (!put(grey.ptr(y), grey.elemSize() * static_cast<std::size_t>(grey.cols))) return false;
    }
    return std::fflush(stdout) == 0;
}

bool is_pipeline(const std::string& source) {
    return source.find('!') != std::string::npos;
}

bool open(cv::VideoCapture& camera, std::string source) {
    if (!is_pipeline(source)) {
        const bool is_open = is_number(source) ? camera.open(std::stoi(source), cv::CAP_V4L2)
                                               : camera.open(source, cv::CAP_V4L2);
        if (is_open) choose_grey(camera);
        return is_open;
    }
    if (source.find("appsink") == std::string::npos) source += " ! appsink sync=false";
    return camera.open(source, cv::CAP_GSTREAMER);
}

int capture(const std::string& source) {
    cv::VideoCapture camera;
    if (!open(camera, source)) return refuse("neither V4L2 nor GStreamer opens it");
    cv::Mat picture, grey, first;
    while (camera.read(picture)) {
        if (!to_grey(picture, grey)) {
            return refuse("its frames are neither grey nor colours of 8 or 16 bit");
        }
        if (first.empty()) {
            grey.copyTo(first);
            const std::string text = header(grey, camera.get(cv::CAP_PROP_FPS));
            if (!put(text.data(), text.size())) return done;
        }
        if (grey.size() != first.size() || grey.type() != first.type()) {
            return refuse("its frames changed their size or depth");
        }
        if (!put(grey)) return done;  // nobody reads any more
    }
    if (first.empty()) return refuse("it gives no frame");
    if (!is_pipeline(source)) return refuse("the camera gives no more frames");
    // OpenCV does not tell the end of a pipeline from its failure.
    return done;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() != 1 || words[0].starts_with("--")) {
        std::fputs("usage: grainfield-capture /dev/videoN|N|'GSTREAMER ! PIPELINE'\n", stderr);
        return bad_usage;
    }
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR);
    try {
        return capture(words[0]);
    } catch (const std::exception& error) {
        return refuse(error.what());
    }
}
