#include "pipelines/size_check.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A machine whose files say 8 GB available; no limit of a real process is as low as these.
class SizeCheckOf : public ::testing::Test {
 protected:
    SizeCheckOf() { write("proc/meminfo", "MemTotal: 16000000 kB\nMemAvailable:   8000 kB\n"); }

    void write(const std::string& name, const std::string& text) {
        const fs::path path = root_.path() / name;
        fs::create_directories(path.parent_path());
        std::ofstream(path) << text;
    }
    double available() const { return available_memory(root_.path()); }

 private:
    testing::ScratchFolder root_;
};

}  // namespace

TEST_F(SizeCheckOf, ASystemWithoutGroupsIsWhatItHasAvailable) {
    EXPECT_EQ(available(), 8000.0 * 1024);
}

TEST_F(SizeCheckOf, AGroupLeavesItsLimitLessItsUseAndDroppableCaches) {
    write("proc/self/cgroup", "0::/a/b\n");
    write("sys/fs/cgroup/a/b/memory.max", "5000000\n");
    write("sys/fs/cgroup/a/b/memory.current", "3000000\n");
    write("sys/fs/cgroup/a/b/memory.stat", "anon 7\ninactive_file 400000\n");
    EXPECT_EQ(available(), 2400000);
}

TEST_F(SizeCheckOf, AGroupAboveLimitsToo) {
    write("proc/self/cgroup", "0::/a/b\n");
    write("sys/fs/cgroup/a/memory.max", "1000000\n");
    write("sys/fs/cgroup/a/memory.current", "100000\n");
    write("sys/fs/cgroup/a/b/memory.max", "max\n");
    write("sys/fs/cgroup/a/b/memory.current", "100000\n");
    EXPECT_EQ(available(), 900000);
}

TEST_F(SizeCheckOf, GroupsOfTheFirstVersionAreRead) {
    write("proc/self/cgroup", "9:name=systemd:/\n4:cpu,memory:/job\n0::/\n");
    write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "700000\n");
    write("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "800000\n");
    write("sys/fs/cgroup/memory/job/memory.stat", "total_inactive_file 0\n");
    EXPECT_EQ(available(), 0) << "used beyond its limit";
}

TEST(SizeCheck, ThisMachineHasSomeMemory) {
    EXPECT_GT(available_memory(), 1e6);
}

TEST(SizeCheck, AJobThatFitsIsPlannedWithItsSize) {
    RunPlan plan;
    require_room({.bytes = 2e9, .seconds = 7200}, 4e9, "-", SizeCheck::refuse, plan);
    EXPECT_THAT(plan.text(), HasSubstr("about 2 GB of memory and 2 h; 4 GB are free"));
    EXPECT_TRUE(plan.warnings().empty());
}

TEST(SizeCheck, TooMuchMemoryOrTimeIsRefusedWithBothNumbersUnlessInsistedOn) {
    for (const JobSize& size : {JobSize{6.2e10, 3600 * 50.0}, JobSize{1e6, 3e12}}) {
        RunPlan plan;
        const bool is_large = size.bytes > 4e9;
        const std::string needed = is_large ? "about 62 GB of memory and 2 days"
                                            : "about 1 MB of memory and 9.51e+04 years";
        try {
            require_room(size, 4e9, "use less", SizeCheck::refuse, plan);
            FAIL() << needed;
        } catch (const OptionError& error) {
            EXPECT_THAT(error.what(), HasSubstr(needed));
            EXPECT_THAT(error.what(), HasSubstr("at most 4 GB, which are free, and a year"));
            EXPECT_THAT(error.what(), HasSubstr("use less, or insist with option 'force-size'"));
        }
        require_room(size, 4e9, "use less", SizeCheck::insist, plan);
        ASSERT_EQ(plan.warnings().size(), 1U);
        EXPECT_THAT(plan.warnings()[0].text, HasSubstr(needed));
    }
}

}  // namespace grainfield::pipelines
