#include <cmath>

#include <fmt/format.h>

#include "io/h5/detail/h5_group.h"
#include "io/h5/detail/legacy_identity.h"
#include "io/h5/detail/observable_group.h"
#include "io/h5/detail/run_record_json.h"
#include "io/h5/field_file.h"

namespace grainfield::io {

struct FieldFile::State {
    explicit State(const std::filesystem::path& path) : file(H5File::open(path)) {
        const H5Group root = H5Group::root(file);
        if (!root.has_group("field")) {
            file.fail("there is no field in it", "a file of 'grainfield simulate field'");
        }
        group = root.group("field");
        if (const double version = group.number_attribute("version"); version != 1) {
            file.fail(fmt::format("fields of format version {}", version), "version 1");
        }
        step = group.dataset("step").read<std::int64_t>();
        time = group.dataset("time").read<double>();
        diffusivity = group.dataset("mean_diffusivity").read<double>();
        if (time.size() != step.size() || diffusivity.size() != step.size()) {
            file.fail("step, time and mean_diffusivity have different lengths");
        }
        open_fields();
        try {
            const H5Group own = group.group("statistics");
            statistics = read_observables(own.group("curves"),
                                          parse_json(own.text("observables"), file.name()));
        } catch (const nlohmann::json::exception& error) {
            file.fail(fmt::format("the statistics are damaged ({})", error.what()));
        }
        record = record_from_json(parse_json(group.text("record"), file.name()), file.name());
        identity =
            group.has("identity")
                ? identity_from_json(parse_json(group.text("identity"), file.name()), file.name())
                : legacy_field_identity(record);
    }

    void open_fields() {
        if (step.empty()) return;
        const double wanted = group.number_attribute("dimension");
        spacing = group.number_attribute("spacing");
        if (!(wanted == 1 || wanted == 2) || !(spacing > 0) || !std::isfinite(spacing)) {
            file.fail(fmt::format("a lattice of dimension {} and spacing {}", wanted, spacing));
        }
        dimension = static_cast<int>(wanted);
        density = group.dataset("density");
        extent = density.extent();
        if (extent.size() != 4 || extent[0] != step.size() || extent[1] < 1 || extent[2] < 1 ||
            extent[3] < 1 || extent[2] > (1U << 24U) || extent[3] > (1U << 24U)) {
            file.fail(fmt::format("{} is {}", density.path(), density.extent_text()),
                      fmt::format("{} fields [frames, replicas, ny, nx]", step.size()));
        }
        if (!group.has("order")) return;
        order = group.dataset("order");
        if (order.extent() != H5Extent{extent[0], extent[2], extent[3]}) {
            file.fail(fmt::format("{} is {}", order.path(), order.extent_text()),
                      "the lattice of the density");
        }
    }

    FieldFrame read(std::size_t index) const {
        FieldFrame frame;
        frame.dimension = dimension;
        frame.mean_diffusivity = diffusivity[index];
        DensityField like;
        like.step = step[index];
        like.time = time[index];
        like.nx = static_cast<int>(extent[3]);
        like.ny = static_cast<int>(extent[2]);
        like.spacing = spacing;
        const std::vector<double> all = density.read_row<double>(index);
        const auto cells = static_cast<std::ptrdiff_t>(extent[2] * extent[3]);
        for (std::size_t r = 0; r < extent[1]; ++r) {
            DensityField field = like;
            const auto first = all.begin() + static_cast<std::ptrdiff_t>(r) * cells;
            field.value.assign(first, first + cells);
            frame.density.push_back(std::move(field));
        }
        if (order) {
            frame.order = like;
            frame.order.value = order.read_row<double>(index);
        }
        return frame;
    }

    H5File file;
    H5Group group;
    std::vector<std::int64_t> step;
    std::vector<double> time, diffusivity;
    int dimension = 2;
    double spacing = 1;
    H5Dataset density, order;
    H5Extent extent;
    std::vector<ObservableResult> statistics;
    RunRecord record;
    RunIdentity identity;
};

FieldFile::FieldFile(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {}
FieldFile::~FieldFile() = default;
FieldFile::FieldFile(FieldFile&&) noexcept = default;

std::int64_t FieldFile::count() const {
    return static_cast<std::int64_t>(state_->step.size());
}

FieldFrame FieldFile::read(std::int64_t index) {
    if (index < 0 || index >= count()) {
        state_->file.fail(fmt::format("there is no field number {}", index));
    }
    return state_->read(static_cast<std::size_t>(index));
}

const std::vector<ObservableResult>& FieldFile::statistics() const {
    return state_->statistics;
}

const RunRecord& FieldFile::record() const {
    return state_->record;
}

const RunIdentity& FieldFile::identity() const {
    return state_->identity;
}

}  // namespace grainfield::io
