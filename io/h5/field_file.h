#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/density_field.h"
#include "core/results.h"
#include "core/support/output_file.h"

namespace grainfield::io {

/// Writes a series of fields as HDF5:
///
///   /field                    attributes version, dimension, spacing
///   /field/step, time         [frames]
///   /field/mean_diffusivity   [frames]
///   /field/density            [frames × replicas × ny × nx], double
///   /field/order              [frames × ny × nx], where there is an order field
///   /field/statistics         what was measured while the run went on (observables)
///   /field/record             how it came to be (JSON)
///   /field/identity           which model, and its control parameter (JSON)
///
/// The file appears under its name with finish(). Throws OutputError as OutputFile does, when the
/// disk is full, and when the lattice changes from frame to frame.
class FieldWriter : public FieldSink {
 public:
    FieldWriter(const std::filesystem::path& path, Overwrite overwrite);
    ~FieldWriter() override;
    FieldWriter(FieldWriter&&) noexcept;

    void write(const FieldFrame& frame) override;
    void finish(const std::vector<ObservableResult>& statistics, const RunIdentity& identity,
                const RunRecord& record);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Reads what FieldWriter wrote, every bit. Throws InputError, naming the file, if it is missing,
/// damaged, or not a field file.
class FieldFile : public FieldSource {
 public:
    explicit FieldFile(const std::filesystem::path& path);
    ~FieldFile() override;
    FieldFile(FieldFile&&) noexcept;

    std::int64_t count() const override;
    FieldFrame read(std::int64_t index) override;
    const std::vector<ObservableResult>& statistics() const;
    const RunRecord& record() const;
    const RunIdentity& identity() const;

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace grainfield::io
