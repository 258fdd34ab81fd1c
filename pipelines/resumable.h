#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/support/checkpoint.h"
#include "io/h5/record_log.h"
#include "pipelines/configuration.h"
#include "pipelines/job.h"

namespace grainfield::pipelines {

/// When a long job is saved, and whether it goes on from what an earlier run saved.
struct ResumeOptions {
    bool resume = false;                       ///< go on from the checkpoint if it is there
    std::chrono::duration<double> every{60};   ///< wall time between checkpoints [s]
    std::string_view how = "option 'resume'";  ///< what a user does to go on
};

/// A job is to be resumed whose output is complete: there is nothing to do.
class AlreadyComplete : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

/// What makes a long job stoppable anywhere: killed and taken up again, it ends in the same output.
///
/// Beside the output stand OUTPUT.checkpoint, the state at some moment, and a log, all records that
/// were stored up to there. A checkpoint notes how much of the log it vouches for; what came later
/// is cut off and made again. Both are removed when the job is done. A job that fails before its
/// first checkpoint leaves neither.
///
/// The order of calls: construct (reads and compares), require_free, claim the output, start, then
/// save whenever is_due and after a signal, and finish.
class Resumable {
 public:
    /// What a checkpoint belongs to.
    struct Identity {
        std::string kind;              ///< of the Checkpoint: "md", "field", "track"
        std::filesystem::path output;  ///< the file that the job makes in the end
        std::string log;               ///< suffix of the log: ".snapshots"; empty: none
        Configuration configuration;   ///< all that the result depends on
        /// The output that holds the record of a complete run; empty: none does.
        std::filesystem::path record{};
        /// Settings, "section.name", that may differ from those of a checkpoint that a failed run
        /// left. One must: else it would fail again.
        std::vector<std::string> cures{};
    };

    /// Reads the checkpoint if the job is to be resumed and one is there; without one the job
    /// starts from the beginning. Throws InputError, with the difference, if it is of another kind,
    /// version of the program or configuration. After a failure (save_failed) the cures may differ;
    /// that they do is a warning of this run and of all that go on from it. Where the output is
    /// there and no checkpoint: AlreadyComplete if its record says that this job made it,
    /// InputError, with the difference, if another one did, unless outputs may be replaced.
    Resumable(Job& job, Identity identity, const ResumeOptions& options);
    ~Resumable();
    Resumable(const Resumable&) = delete;
    Resumable& operator=(const Resumable&) = delete;

    /// To go on from; null: from the beginning.
    const Checkpoint* from() const { return from_ ? &*from_ : nullptr; }
    /// Says in the plan where the job starts and how often it is saved.
    void explain();

    /// Throws OutputError if a checkpoint is there that is neither gone on from nor to be replaced.
    void require_free() const;
    /// For the output of the job: a resumed run may replace what it has completed itself.
    Overwrite overwrite() const;
    /// Opens the log. A run that is gone on from is recorded as one: its wall time adds up. Call it
    /// once, after the output was claimed.
    void start();
    /// Call after start(), if the identity names one.
    io::RecordLog& log() { return *log_; }

    bool is_due() const;
    /// Brings the log and then `state` to the disk. `records`: how many of the log the state
    /// vouches for; by default all.
    void save(Checkpoint state, std::optional<std::int64_t> records = std::nullopt);
    /// The same of a run that failed after this state: with another cure it can go on.
    void save_failed(Checkpoint state, std::int64_t records, const std::string& failure);
    /// "interrupted after 3 of 40 frames", and how to go on if that is possible.
    Warning interrupted(double done, double all, const std::string& units,
                        const std::string& kept = "") const;
    /// "; option 'resume' goes on from there" if that is possible. Safe from any thread.
    std::string advice() const;
    /// The last act (InterruptDeadline) of a job that a signal ends before it could save itself:
    /// leaves nothing that is of no use, and says what is left. Safe from any thread.
    std::string cut_off(int signal) const;
    /// The output is complete: removes checkpoint and log.
    void finish();
    /// The process ends at once: leaves nothing that is of no use. Safe from any thread.
    void abandon() const;

    const std::filesystem::path& output() const { return identity_.output; }
    std::filesystem::path checkpoint_path() const { return with_suffix(".checkpoint"); }

 private:
    std::filesystem::path with_suffix(const std::string& suffix) const;
    void require_same_run(const Checkpoint& checkpoint);
    /// The settings of this run with the cures of the checkpoint; a warning for what differs.
    Configuration with_cures_of(const Checkpoint& checkpoint);
    void look_for_complete_output() const;
    std::int64_t log_bytes() const;

    Job& job_;
    Identity identity_;
    ResumeOptions options_;
    std::optional<Checkpoint> from_;
    std::optional<io::RecordLog> log_;
    std::vector<std::string> cured_;  ///< what earlier runs failed of, and what was changed
    bool is_saved_ = false;           ///< a checkpoint stands on the disk
    std::chrono::steady_clock::time_point saved_ = std::chrono::steady_clock::now();
};

}  // namespace grainfield::pipelines
