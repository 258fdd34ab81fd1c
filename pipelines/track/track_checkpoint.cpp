#include "pipelines/track/track_checkpoint.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/checkpoint_file.h"
#include "io/input_record.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

/// Options that may change between an interrupted run and the one that goes on.
constexpr std::array<std::string_view, 11> not_compared{
    "output", "threads", "explain", "json",       "quiet",           "verbose",
    "force",  "resume",  "strict",  "max-pixels", "checkpoint-every"};

/// Options that results depend on, the pictures they name, and the inputs. The content of the
/// inputs is not read for it: calibration shows whether it is the same film.
std::vector<std::pair<std::string, std::string>> compared(
    const Session& session, const std::vector<std::string>& pictures) {
    std::vector<std::pair<std::string, std::string>> kept;
    for (const auto& option : session.configuration) {
        if (std::ranges::find(not_compared, option.first) == not_compared.end()) {
            kept.push_back(option);
        }
    }
    for (const std::string& picture : pictures) {
        const RunRecord::Input record = io::describe_input(picture);
        throw_if_interrupted("tracking");
        kept.emplace_back(fmt::format("content of '{}'", picture),
                          fmt::format("{} bytes, {}", record.bytes, record.checksum));
    }
    std::uintmax_t bytes = 0;
    for (const fs::path& input : session.inputs) {
        std::error_code unreadable;
        const std::uintmax_t size = fs::file_size(input, unreadable);
        if (!unreadable) bytes += size;
    }
    kept.emplace_back(
        "input",
        session.inputs.empty()
            ? std::string("none")
            : fmt::format("{} from '{}', {} bytes",
                          counted(static_cast<std::int64_t>(session.inputs.size()), "file"),
                          session.inputs.front().filename().string(), bytes));
    return kept;
}

std::int64_t log_bytes(const Checkpoint& checkpoint, const fs::path& path) {
    const auto found = checkpoint.integers.find("log bytes");
    if (found == checkpoint.integers.end() || found->second.size() != 1 || found->second[0] < 0) {
        throw InputError({.problem = fmt::format("cannot go on from '{}'", path.string()),
                          .actual = "it is not one of a tracking run",
                          .expected = {},
                          .suggestion = "start again without --resume"});
    }
    return found->second[0];
}

}  // namespace

TrackCheckpoint::TrackCheckpoint(const Session& session, const std::vector<std::string>& pictures,
                                 const std::string& output, const Options& options)
    : output_(output), options_(options), configuration_(compared(session, pictures)) {
    std::error_code ignored;
    is_there_ = fs::exists(path(), ignored);
    if (!is_there_) return;
    if (options_.resume) {
        from_ = io::read_checkpoint(path());
        io::require_same_configuration(*from_, configuration_, path());
        log_bytes(*from_, path());
    } else if (!session.common.force && !session.common.explain) {
        throw OutputError({.problem = fmt::format("'{}' exists: an interrupted run of '{}'",
                                                  path().string(), output_.string()),
                           .actual = {},
                           .expected = {},
                           .suggestion = "go on with --resume, or start anew with --force"});
    }
}

TrackCheckpoint::~TrackCheckpoint() {
    if (log_ && !is_there_) log_->remove();
}

fs::path TrackCheckpoint::with_suffix(const char* suffix) const {
    fs::path path = output_;
    path += suffix;
    return path;
}

std::vector<std::int64_t> TrackCheckpoint::previews() const {
    if (!from_) return {};
    const auto found = from_->integers.find("previews");
    return found == from_->integers.end() ? std::vector<std::int64_t>{} : found->second;
}

double TrackCheckpoint::seconds_before() const {
    if (!from_) return 0;
    const auto found = from_->reals.find("seconds");
    return found == from_->reals.end() || found->second.empty() ? 0 : found->second.front();
}

io::SnapshotLog* TrackCheckpoint::open_log() {
    // One that is not gone on from must not outlive the snapshots it vouches for.
    if (!from_ && is_there_) {
        fs::remove(path());
        is_there_ = false;
    }
    log_.emplace(with_suffix(".snapshots"), from_ ? log_bytes(*from_, path()) : 0);
    saved_ = std::chrono::steady_clock::now();
    return &*log_;
}

bool TrackCheckpoint::is_due() const {
    return std::chrono::steady_clock::now() - saved_ >=
           std::chrono::duration<double>(60 * options_.every);
}

void TrackCheckpoint::save(Checkpoint&& state, const std::vector<std::int64_t>& previews,
                           const Session& session) {
    log_->sync();
    Checkpoint checkpoint = std::move(state);
    checkpoint.configuration = configuration_;
    checkpoint.integers["log bytes"] = {log_->bytes()};
    checkpoint.integers["previews"] = previews;
    checkpoint.reals["seconds"] = {session.seconds()};
    io::write_checkpoint(checkpoint, path());
    is_there_ = true;
    saved_ = std::chrono::steady_clock::now();
}

std::string TrackCheckpoint::advice() const {
    std::error_code ignored;
    return fs::exists(path(), ignored) ? "; go on with --resume" : "";
}

void TrackCheckpoint::abandon() const {
    std::error_code ignored;
    if (!fs::exists(path(), ignored)) fs::remove(with_suffix(".snapshots"), ignored);
}

void TrackCheckpoint::remove() {
    std::error_code ignored;
    fs::remove(path(), ignored);
    is_there_ = false;
}

}  // namespace grainfield::pipelines
