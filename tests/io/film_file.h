#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/frame_files.h"
#include "tests/io/picture_files.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {

/// A file of frames that a test writes with other and other contents and opens.
class FilmFile : public ::testing::Test {
 protected:
    explicit FilmFile(std::string name) : name_(std::move(name)) {}

    std::unique_ptr<FrameSource> open(const std::string& content,
                                      const FrameFileOptions& options = {}) {
        picture_files::write_content(path_, content);
        return open_frames({path_}, options);
    }

    /// Opens a damaged file and reads up to four frames. False: it was refused, by its name.
    bool opens_or_is_refused(const std::string& content, const FrameFileOptions& options = {}) {
        try {
            const auto film = open(content, options);
            for (std::int64_t f = 0; f < std::min<std::int64_t>(film->count(), 4); ++f) {
                film->read(f);
            }
            return true;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr(name_));
            return false;
        }
    }

    testing::ScratchFolder folder_;
    std::string name_;
    std::string path_ = folder_ / name_;
};

}  // namespace grainfield::io
