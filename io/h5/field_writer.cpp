#include <array>
#include <span>

#include <fmt/format.h>

#include "core/version.h"
#include "io/h5/detail/data_digest.h"
#include "io/h5/detail/h5_group.h"
#include "io/h5/detail/observable_group.h"
#include "io/h5/detail/run_record_json.h"
#include "io/h5/field_file.h"

namespace grainfield::io {

namespace {

constexpr hsize_t scalars_per_chunk = 1024;

}  // namespace

struct FieldWriter::State {
    State(const std::filesystem::path& path, Overwrite overwrite)
        : output(path, overwrite),
          file(H5File::create(output.temporary(), path.string())),
          group(H5Group::root(file).make_group("field")) {
        group.set_attribute("version", std::int64_t{1});
        step = group.make_series<std::int64_t>("step", {}, {scalars_per_chunk}, -1);
        time = group.make_series<double>("time", {}, {scalars_per_chunk}, 0);
        diffusivity = group.make_series<double>("mean_diffusivity", {}, {scalars_per_chunk}, 0);
    }

    void prepare(const FieldFrame& frame) {
        const DensityField& like = frame.density.front();
        nx = static_cast<hsize_t>(like.nx);
        ny = static_cast<hsize_t>(like.ny);
        replicas = frame.density.size();
        has_order = !frame.order.value.empty();
        group.set_attribute("dimension", std::int64_t{frame.dimension});
        group.set_attribute("spacing", like.spacing);
        density = group.make_series<double>("density", {replicas, ny, nx}, {1, 1, ny, nx}, 0);
        if (has_order) order = group.make_series<double>("order", {ny, nx}, {1, ny, nx}, 0);
    }

    void require_same(const FieldFrame& frame) const {
        const DensityField& like = frame.density.front();
        if (static_cast<hsize_t>(like.nx) != nx || static_cast<hsize_t>(like.ny) != ny ||
            frame.density.size() != replicas || frame.order.value.empty() == has_order) {
            file.fail(fmt::format("the field of step {} has another shape", like.step));
        }
    }

    void write(const FieldFrame& frame) {
        if (!density) prepare(frame);
        require_same(frame);
        std::vector<double> all;
        all.reserve(replicas * nx * ny);
        for (const DensityField& field : frame.density) {
            all.insert(all.end(), field.value.begin(), field.value.end());
        }
        density.extend(frames + 1, replicas);
        density.write_row<double>(frames, replicas, all);
        if (has_order) {
            order.extend(frames + 1, ny);
            order.write_row<double>(frames, ny, frame.order.value);
        }
        const DensityField& first = frame.density.front();
        append<std::int64_t>(step, first.step);
        append<double>(time, first.time);
        append<double>(diffusivity, frame.mean_diffusivity);
        ++frames;
    }

    template <class T>
    void append(const H5Dataset& data, T value) {
        data.extend(frames + 1, 0);
        data.write_row<T>(frames, 1, std::array{value});
    }

    OutputFile output;
    H5File file;
    H5Group group;
    H5Dataset step, time, diffusivity, density, order;
    hsize_t nx = 0, ny = 0, replicas = 0, frames = 0;
    bool has_order = false;
};

FieldWriter::FieldWriter(const std::filesystem::path& path, Overwrite overwrite)
    : state_(std::make_unique<State>(path, overwrite)) {}
FieldWriter::~FieldWriter() = default;
FieldWriter::FieldWriter(FieldWriter&&) noexcept = default;

void FieldWriter::write(const FieldFrame& frame) {
    state_->write(frame);
}

void FieldWriter::finish(const std::vector<ObservableResult>& statistics,
                         const RunIdentity& identity, const RunRecord& record) {
    require_rectangular(statistics, state_->file);
    const H5Group group = state_->group.make_group("statistics");
    const nlohmann::json text = write_observables(group.make_group("curves"), statistics);
    group.write_text("observables", text_of(text));
    state_->group.write_text("identity", text_of(to_json(identity)));
    state_->group.write_text("record", text_of(to_json(record)));
    store_digest(state_->file);
    state_->file.close();
    state_->output.commit();
}

}  // namespace grainfield::io
