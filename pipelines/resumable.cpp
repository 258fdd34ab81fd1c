#include "pipelines/resumable.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/errors.h"
#include "core/version.h"
#include "io/file_kind.h"
#include "io/h5/checkpoint_file.h"
#include "io/h5/field_file.h"
#include "io/h5/trajectory_file.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* version_key = "program version";
constexpr const char* failure_key = "failure";
constexpr const char* cured_key = "cured failures";

bool is_there(const fs::path& path) {
    std::error_code unreachable;
    return fs::exists(path, unreachable);
}

// Whether a run that lives holds the temporary of its output (OutputFile).
bool is_locked(const fs::path& temporary) {
    const int descriptor = ::open(temporary.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor < 0) return false;
    const bool is_free = ::flock(descriptor, LOCK_SH | LOCK_NB) == 0;
    const bool is_held = !is_free && errno == EWOULDBLOCK;
    ::close(descriptor);
    return is_held;
}

std::string version_of(const Checkpoint& checkpoint) {
    const auto found = checkpoint.texts.find(version_key);
    return found == checkpoint.texts.end() || found->second.size() != 1 ? std::string()
                                                                        : found->second.front();
}

std::optional<RunRecord> record_of(const fs::path& path) {
    try {
        switch (io::identify(path)) {
            case io::FileKind::trajectory:
                return io::TrajectoryFile(path).record();
            case io::FileKind::field:
                return io::FieldFile(path).record();
            default:
                return std::nullopt;
        }
    } catch (const InputError&) {
        return std::nullopt;
    }
}

/// In what the run that a record is of differs from the job, as far as outputs depend on it; empty:
/// in nothing.
std::string differences_of(const RunRecord& made, const Job& job) {
    const RunRecord now = job.record();
    std::string text;
    const auto compare = [&](const std::string& name, const std::string& there,
                             const std::string& here) {
        if (there == here || std::ranges::find(job.indifferent, name) != job.indifferent.end())
            return;
        text += fmt::format("{}{}: {} there, {} now", text.empty() ? "" : "; ", name,
                            there.empty() ? "nothing" : there, here.empty() ? "nothing" : here);
    };
    compare("command", made.command, now.command);
    compare("version", made.version, now.version);
    compare("seed", std::to_string(made.seed), std::to_string(now.seed));
    const auto value_in = [](const RunRecord& record, const std::string& name) {
        for (const auto& [known, value] : record.configuration) {
            if (known == name) return value;
        }
        return std::string();
    };
    for (const auto& [name, value] : made.configuration) compare(name, value, value_in(now, name));
    for (const auto& [name, value] : now.configuration) {
        if (value_in(made, name).empty()) compare(name, "", value);
    }
    const auto contents = [](const RunRecord& record) {
        std::string all;
        for (const RunRecord::Input& input : record.inputs) {
            all += fmt::format("{} B {} ", input.bytes, input.checksum);
        }
        return all;
    };
    if (contents(made) != contents(now)) {
        text += fmt::format("{}the content of its inputs", text.empty() ? "" : "; ");
    }
    return text;
}

[[noreturn]] void refuse(const fs::path& path, std::string actual, std::string expected,
                         std::string suggestion) {
    throw InputError({.problem = fmt::format("cannot go on from '{}'", path.string()),
                      .actual = std::move(actual),
                      .expected = std::move(expected),
                      .suggestion = std::move(suggestion)});
}

}  // namespace

Resumable::Resumable(Job& job, Identity identity, const ResumeOptions& options)
    : job_(job), identity_(std::move(identity)), options_(options) {
    // Without an output, which a plan need not have, there is nothing beside it.
    is_saved_ = !identity_.output.empty() && is_there(checkpoint_path());
    if (!options_.resume) return;
    if (!is_saved_) {
        look_for_complete_output();
        return;
    }
    from_ = io::read_checkpoint(checkpoint_path());
    require_same_run(*from_);
    log_bytes();
}

Resumable::~Resumable() {
    if (log_ && !is_saved_) log_->remove();
}

fs::path Resumable::with_suffix(const std::string& suffix) const {
    fs::path path = identity_.output;
    path += suffix;
    return path;
}

void Resumable::require_same_run(const Checkpoint& checkpoint) {
    if (checkpoint.kind != identity_.kind) {
        refuse(checkpoint_path(), fmt::format("it is of kind '{}'", checkpoint.kind),
               fmt::format("kind '{}'", identity_.kind), "start the run anew");
    }
    if (const std::string version = version_of(checkpoint); version != kVersion) {
        refuse(checkpoint_path(),
               version.empty() ? std::string("it does not say which version wrote it")
                               : fmt::format("version {} wrote it", version),
               fmt::format("version {}, as this program", kVersion),
               "finish the run with the program that began it, or start it anew");
    }
    const bool has_failed = checkpoint.texts.contains(failure_key);
    io::require_same_configuration(checkpoint,
                                   has_failed ? with_cures_of(checkpoint) : identity_.configuration,
                                   checkpoint_path());
    if (const auto found = checkpoint.texts.find(cured_key); found != checkpoint.texts.end()) {
        cured_.insert(cured_.begin(), found->second.begin(), found->second.end());
    }
    for (const std::string& cured : cured_) job_.plan.warn(cured);
}

Configuration Resumable::with_cures_of(const Checkpoint& checkpoint) {
    Configuration settings = identity_.configuration;
    std::string changes, names;
    for (const std::string& cure : identity_.cures) {
        const auto is_it = [&](const auto& setting) { return setting.first == cure; };
        const auto before = std::ranges::find_if(checkpoint.configuration, is_it);
        const auto now = std::ranges::find_if(settings, is_it);
        names += (names.empty() ? "" : " or ") + cure;
        if (before == checkpoint.configuration.end() || now == settings.end()) continue;
        if (before->second == now->second) continue;
        changes += fmt::format("{}{} = {}, {} before", changes.empty() ? "" : "; ", cure,
                               now->second, before->second);
        now->second = before->second;
    }
    const auto& failure = checkpoint.texts.at(failure_key);
    const std::string what = failure.empty() ? std::string("it failed") : failure.front();
    if (changes.empty()) {
        refuse(checkpoint_path(), fmt::format("the run failed there: {}", what),
               fmt::format("another {}", names), "change one of them, or start the run anew");
    }
    cured_.push_back(fmt::format("goes on after a failure with {}: {}", changes, what));
    return settings;
}

void Resumable::look_for_complete_output() const {
    if (job_.overwrite == Overwrite::force || identity_.record.empty()) return;
    if (!is_there(identity_.output) || !is_there(identity_.record)) return;
    const std::optional<RunRecord> made = record_of(identity_.record);
    if (!made || made->command.empty()) return;  // not one of ours: it exists, as any file
    const bool is_cut_short = std::ranges::any_of(made->warnings, [](const Warning& warning) {
        return warning.code == WarningCode::incomplete || warning.code == WarningCode::interrupted;
    });
    if (is_cut_short) return;
    const std::string differences = differences_of(*made, job_);
    if (!differences.empty()) {
        throw InputError({.problem = fmt::format("'{}' is complete, and was made otherwise",
                                                 identity_.output.string()),
                          .actual = differences,
                          .expected = "the command and settings that made it",
                          .suggestion = "give another name, or option 'force' to begin anew"});
    }
    throw AlreadyComplete(
        fmt::format("{}: complete already, nothing to do", identity_.output.string()));
}

std::int64_t Resumable::log_bytes() const {
    if (!from_ || identity_.log.empty()) return 0;
    const auto found = from_->integers.find("log bytes");
    if (found == from_->integers.end() || found->second.size() != 1 || found->second[0] < 0) {
        refuse(checkpoint_path(), "it does not say how much was stored", {}, "start the run anew");
    }
    return found->second[0];
}

void Resumable::explain() {
    if (from_) {
        job_.plan.run("resume", "goes on from the checkpoint");
    } else if (options_.resume) {
        job_.plan.run("resume", "there is no checkpoint: starts from the beginning");
    }
    job_.plan.run("checkpoints", fmt::format("every {:g} min", options_.every.count() / 60));
}

void Resumable::require_free() const {
    if (from_ || !is_saved_ || job_.overwrite == Overwrite::force) return;
    if (is_locked(with_suffix(".partial"))) {
        throw OutputError({.problem = fmt::format("cannot write '{}'", identity_.output.string()),
                           .actual = "another run is writing it",
                           .expected = {},
                           .suggestion = "wait until it is done, or give another name"});
    }
    throw OutputError(
        {.problem = fmt::format("'{}' exists: an interrupted run of '{}'",
                                checkpoint_path().string(), identity_.output.string()),
         .actual = {},
         .expected = {},
         .suggestion =
             fmt::format("{} goes on with it, option 'force' starts anew", options_.how)});
}

Overwrite Resumable::overwrite() const {
    return from_ ? Overwrite::force : job_.overwrite;
}

void Resumable::start() {
    if (from_) {
        const auto found = from_->reals.find("seconds");
        const double before =
            found == from_->reals.end() || found->second.empty() ? 0 : found->second.front();
        job_.start -=
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(before));
    } else if (is_saved_) {
        // One that is not gone on from must not outlive the records that it vouches for.
        fs::remove(checkpoint_path());
        is_saved_ = false;
    }
    if (!identity_.log.empty()) log_.emplace(with_suffix(identity_.log), log_bytes());
    saved_ = Clock::now();
}

bool Resumable::is_due() const {
    return Clock::now() - saved_ >= options_.every;
}

void Resumable::save_failed(Checkpoint state, std::int64_t records, const std::string& failure) {
    state.texts[failure_key] = {failure};
    save(std::move(state), records);
}

void Resumable::save(Checkpoint state, std::optional<std::int64_t> records) {
    if (log_) {
        log_->sync();
        state.integers["log bytes"] = {records ? log_->bytes_of(*records) : log_->bytes()};
    }
    state.kind = identity_.kind;
    state.configuration = identity_.configuration;
    state.texts[version_key] = {kVersion};
    if (!cured_.empty()) state.texts[cured_key] = cured_;
    state.reals["seconds"] = {job_.seconds()};
    io::write_checkpoint(state, checkpoint_path());
    is_saved_ = true;
    saved_ = Clock::now();
}

Warning Resumable::interrupted(double done, double all, const std::string& units,
                               const std::string& kept) const {
    return {WarningCode::interrupted,
            fmt::format("interrupted after {:.10g} of {:.10g} {}{}{}", done, all, units, kept,
                        done >= all ? std::string() : advice())};
}

std::string Resumable::advice() const {
    return is_there(checkpoint_path()) ? fmt::format("; {} goes on from there", options_.how)
                                       : std::string();
}

std::string Resumable::cut_off(int signal) const {
    abandon();
    const char* name = signal == SIGINT ? "SIGINT" : "SIGTERM";
    if (!is_there(checkpoint_path())) {
        return fmt::format(
            "error: interrupted by {} before anything could be saved; '{}' was not "
            "written.",
            name, identity_.output.string());
    }
    const std::string said =
        fmt::format("warning: interrupted by {}; '{}' holds what was saved last{}", name,
                    checkpoint_path().string(), advice());
    return job_.plan.wording() ? job_.plan.wording()(said) : said;
}

void Resumable::finish() {
    std::error_code ignored;
    fs::remove(checkpoint_path(), ignored);
    is_saved_ = false;
    if (log_) {
        log_->remove();
    } else if (!identity_.log.empty()) {
        fs::remove(with_suffix(identity_.log), ignored);
    }
    log_.reset();
}

void Resumable::abandon() const {
    std::error_code ignored;
    if (!is_there(checkpoint_path()) && !identity_.log.empty()) {
        fs::remove(with_suffix(identity_.log), ignored);
    }
}

}  // namespace grainfield::pipelines
