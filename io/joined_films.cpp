#include "io/joined_films.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <glob.h>

#include "core/errors.h"
#include "io/frame_clock.h"
#include "io/images/file_numbering.h"
#include "io/images/image_formats.h"
#include "io/images/picture.h"
#include "io/input_file.h"

namespace grainfield::io {

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 18> video_extensions{
    ".avi", ".mkv", ".mp4", ".mov", ".cine", ".webm", ".m4v", ".mpg", ".mpeg",
    ".mxf", ".nut", ".wmv", ".asf", ".mj2",  ".y4m",  ".dv",  ".ts",  ".mraw"};

bool natural_before(const fs::path& a, const fs::path& b) {
    return natural_less(a.native(), b.native());
}

std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

bool holds_frames(const fs::path& path, const std::string& extension,
                  std::span<const ImageFormat> formats) {
    if (std::ranges::find(video_extensions, extension) != video_extensions.end()) return true;
    return find_image_format(read_head(path, bytes_to_recognise), formats) != nullptr;
}

std::string counted_kinds(const std::map<std::string, std::vector<fs::path>>& kinds) {
    std::string text;
    for (const auto& [extension, files] : kinds) {
        text += fmt::format("{}{} of *{}", text.empty() ? "" : ", ", files.size(), extension);
    }
    return text.empty() ? "no files" : text;
}

std::vector<fs::path> files_in(const fs::path& folder, std::span<const ImageFormat> formats) {
    std::map<std::string, std::vector<fs::path>> kinds;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        std::error_code unreachable;
        const fs::path& path = entry->path();
        const bool is_hidden = path.filename().native().starts_with('.');
        if (is_hidden || !entry->is_regular_file(unreachable)) continue;
        kinds[extension_of(path)].push_back(path);
    }
    const auto refuse = [&](std::string actual, std::string expected, std::string suggestion) {
        throw InputError(
            {.problem = fmt::format("cannot take the folder '{}' for a film", folder.string()),
             .actual = std::move(actual),
             .expected = std::move(expected),
             .suggestion = std::move(suggestion)});
    };
    if (error) refuse(error.message(), {}, "check the permissions");
    const std::string all = counted_kinds(kinds);
    for (auto& [extension, files] : kinds) std::ranges::sort(files, natural_before);
    // One file shows what all of its name are.
    std::erase_if(kinds, [&](const auto& kind) {
        return !holds_frames(kind.second.front(), kind.first, formats);
    });
    if (kinds.empty()) refuse(all, "pictures or videos", "name the files");
    if (kinds.size() > 1) {
        refuse(counted_kinds(kinds), "files of one kind",
               fmt::format("give a pattern in quotes, e.g. '{}'",
                           (folder / ("*" + kinds.begin()->first)).string()));
    }
    return kinds.begin()->second;
}

bool is_pattern(const fs::path& path) {
    return path.native().find_first_of("*?[") != std::string::npos;
}

std::vector<fs::path> matches(const fs::path& pattern) {
    glob_t found{};
    std::vector<fs::path> files;
    if (glob(pattern.c_str(), GLOB_NOSORT, nullptr, &found) == 0) {
        for (std::size_t i = 0; i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
    }
    globfree(&found);
    if (files.empty()) {
        throw InputError({.problem = fmt::format("no file matches '{}'", pattern.string()),
                          .actual = {},
                          .expected = "pictures or videos",
                          .suggestion = "check the folder and the pattern"});
    }
    std::ranges::sort(files, natural_before);
    return files;
}

/// One file of a recording.
struct Part {
    fs::path path;
    std::int64_t frames = 0;
    std::int64_t before = 0;  ///< frames missing between it and the part before
    std::int64_t first = 0;   ///< number of its first frame in the film
    double start = 0;         ///< time of its first frame [time unit]
    std::optional<FrameStamps> stamps;
};

class JoinedFrames : public FrameSource {
 public:
    JoinedFrames(std::vector<fs::path> files, OpenPart open, std::optional<double> rate)
        : open_(std::move(open)), given_rate_(rate) {
        NumberedFiles numbered = number_files(std::move(files));
        warnings_ = std::move(numbered.warnings);
        const std::vector<fs::path> absent = std::move(numbered.missing_names);
        for (fs::path& file : numbered.files) {
            if (!file.empty()) look_at(std::move(file));
        }
        const bool shared = share_clock();
        if (!shared) warn_of_seams(absent, numbered.step);
        place(shared);
    }

    std::int64_t count() const override { return parts_.back().first + parts_.back().frames; }
    int width() const override { return shape_.width; }
    int height() const override { return shape_.height; }
    int bit_depth() const override { return shape_.bit_depth; }
    std::optional<double> frame_rate() const override { return rate_; }
    const std::vector<std::string>& warnings() const override { return warnings_; }

    std::string name() const override {
        return fmt::format("{} … {} ({} parts)", parts_.front().path.string(),
                           parts_.back().path.filename().string(), parts_.size());
    }

    Frame read(std::int64_t index) override {
        require_frame_index(index, count(), name());
        const auto after = std::ranges::upper_bound(parts_, index, {}, &Part::first);
        const auto number = static_cast<std::size_t>(after - parts_.begin()) - 1;
        const Part& part = parts_[number];
        if (index >= part.first + part.frames) return missing(index, part, *after);
        Frame frame = source(number).read(index - part.first);
        if (frame.status == FrameStatus::corrupt) {
            frame.message = fmt::format("'{}', frame {} of it: {}", part.path.string(),
                                        index - part.first, frame.message);
        }
        frame.time = time_of(index, part, frame.time);
        frame.index = index;
        return frame;
    }

 private:
    static constexpr std::size_t most_open = 16;
    static constexpr double same_rate = 1e-3;
    static constexpr double longest_gap = 1e6;  // frames

    void look_at(fs::path file) {
        const std::unique_ptr<FrameSource> source = open_(file);
        Part part{.path = std::move(file), .frames = source->count(), .stamps = {}};
        if (const auto* clock = dynamic_cast<const FrameClock*>(source.get())) {
            part.stamps = clock->stamps();
        }
        const PictureShape shape{source->width(), source->height(), source->bit_depth()};
        if (parts_.empty()) {
            shape_ = shape;
            rate_ = source->frame_rate();
        } else if (shape != shape_) {
            throw InputError(
                {.problem = fmt::format("'{}' and '{}' are not parts of one film",
                                        parts_.front().path.string(), part.path.string()),
                 .actual = shape.text(),
                 .expected = fmt::format("{}, as in the first", shape_.text()),
                 .suggestion = "track them one by one"});
        }
        take_rate(source->frame_rate(), part.path);
        std::ranges::copy(source->warnings(), std::back_inserter(warnings_));
        parts_.push_back(std::move(part));
    }

    void take_rate(const std::optional<double>& rate, const fs::path& path) {
        if (!rate_ || parts_.empty()) return;
        if (rate && std::abs(*rate - *rate_) <= same_rate * *rate_) return;
        warnings_.push_back(fmt::format(
            "the frame rate of '{}' ({}) is not that of '{}' ({:g} a second); it is taken as "
            "unknown",
            path.string(), rate ? fmt::format("{:g} a second", *rate) : "not known",
            parts_.front().path.string(), *rate_));
        rate_.reset();
    }

    /// Whether the stamps of every file come after those of the one before.
    bool share_clock() const {
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            if (!parts_[i].stamps) return false;
            if (i == 0) continue;
            const FrameStamps& last = *parts_[i - 1].stamps;
            if (parts_[i].stamps->first < last.last + 0.5 * last.interval) return false;
        }
        return true;
    }

    // A clock that all parts share shows what is missing; names only that something is.
    void warn_of_seams(const std::vector<fs::path>& absent, std::int64_t step) {
        for (const fs::path& missing : absent) {
            warnings_.push_back(fmt::format(
                "'{}' is not there: the parts before and after it are joined", missing.string()));
        }
        const std::string first = parts_.front().path.string();
        const std::string last = parts_.back().path.filename().string();
        if (parts_.size() == 2 && step > 1) {
            warnings_.push_back(
                fmt::format("the numbers of '{}' and '{}' are {} apart: parts between them would "
                            "be missing",
                            first, last, step));
        }
        warnings_.push_back(
            fmt::format("the {} parts '{}' … '{}' have no common clock: they are joined as if "
                        "nothing were missing between them",
                        parts_.size(), first, last));
    }

    void place(bool shared) {
        std::int64_t next = 0;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            Part& part = parts_[i];
            if (shared && i > 0) part.before = gap_before(i);
            part.first = next + part.before;
            if (shared && !given_rate_) {
                part.start = part.stamps->first - parts_.front().stamps->first;
            } else {
                part.start = static_cast<double>(part.first) / rate_.value_or(1);
            }
            next = part.first + part.frames;
        }
    }

    /// Throws InputError where the stamps are too far apart for parts of one film.
    std::int64_t gap_before(std::size_t i) {
        const FrameStamps& last = *parts_[i - 1].stamps;
        const double pause = parts_[i].stamps->first - last.last;
        const double frames = std::round(pause / last.interval) - 1;
        if (!(frames > 0)) return 0;
        const std::string seam = fmt::format("between '{}' and '{}'", parts_[i - 1].path.string(),
                                             parts_[i].path.filename().string());
        if (frames > longest_gap) {
            throw InputError(
                {.problem = fmt::format("'{}' and '{}' are not parts of one film",
                                        parts_[i - 1].path.string(), parts_[i].path.string()),
                 .actual = fmt::format("the time stamps leave {:.3g} h {}", pause / 3600, seam),
                 .expected = fmt::format("room for at most {:g} frames", longest_gap),
                 .suggestion = "track them apart, each as a film of its own"});
        }
        warnings_.push_back(fmt::format("{} frames are missing {}: the time stamps leave {:g} s",
                                        frames, seam, pause));
        return static_cast<std::int64_t>(frames);
    }

    double time_of(std::int64_t index, const Part& part, double in_part) const {
        if (!rate_) return static_cast<double>(index);
        if (given_rate_) return static_cast<double>(index) / *given_rate_;
        return part.start + in_part;
    }

    Frame missing(std::int64_t index, const Part& before, const Part& after) const {
        Frame frame;
        frame.index = index;
        frame.bit_depth = shape_.bit_depth;
        frame.status = FrameStatus::missing;
        frame.message = fmt::format("not in '{}' and not in '{}'", before.path.string(),
                                    after.path.filename().string());
        const double end = before.start + static_cast<double>(before.frames) / rate_.value_or(1);
        const double behind = static_cast<double>(index - before.first - before.frames);
        frame.time = time_of(index, before, end - before.start + behind / rate_.value_or(1));
        return frame;
    }

    FrameSource& source(std::size_t number) {
        const auto known = std::ranges::find(opened_, number, &Opened::number);
        if (known != opened_.end()) {
            std::rotate(known, known + 1, opened_.end());  // the last is the one used last
        } else {
            if (opened_.size() == most_open) opened_.erase(opened_.begin());
            opened_.push_back({number, open_(parts_[number].path)});
            require_unchanged(number);
        }
        return *opened_.back().source;
    }

    void require_unchanged(std::size_t number) const {
        const std::int64_t frames = opened_.back().source->count();
        if (frames == parts_[number].frames) return;
        throw InputError({.problem = fmt::format("'{}' has changed since it was opened",
                                                 parts_[number].path.string()),
                          .actual = fmt::format("{} frames", frames),
                          .expected = fmt::format("{}", parts_[number].frames),
                          .suggestion = "wait until the recording is complete"});
    }

    struct Opened {
        std::size_t number = 0;
        std::unique_ptr<FrameSource> source;
    };

    OpenPart open_;
    std::optional<double> given_rate_;
    std::vector<Part> parts_;
    std::vector<Opened> opened_;
    PictureShape shape_;
    std::optional<double> rate_;
    std::vector<std::string> warnings_;
};

}  // namespace

std::vector<fs::path> recording_files(const std::vector<fs::path>& inputs) {
    return recording_files(inputs, image_formats());
}

std::vector<fs::path> recording_files(const std::vector<fs::path>& inputs,
                                      std::span<const ImageFormat> formats) {
    std::vector<fs::path> files;
    for (const fs::path& input : inputs) {
        std::error_code error;
        std::vector<fs::path> more{input};
        if (fs::is_directory(input, error)) {
            more = files_in(input, formats);
        } else if (is_pattern(input) && !fs::exists(input, error)) {
            more = matches(input);
        }
        std::ranges::move(more, std::back_inserter(files));
    }
    return files;
}

std::unique_ptr<FrameSource> join_parts(std::vector<fs::path> files, const OpenPart& open,
                                        std::optional<double> rate) {
    return std::make_unique<JoinedFrames>(std::move(files), open, rate);
}

}  // namespace grainfield::io
