#include "io/h5/results_file.h"

#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/h5/detail/data_digest.h"
#include "io/h5/detail/h5_group.h"
#include "io/h5/detail/legacy_identity.h"
#include "io/h5/detail/observable_group.h"
#include "io/h5/detail/preview_group.h"
#include "io/h5/detail/run_record_json.h"

namespace grainfield::io {

namespace {

using nlohmann::json;

constexpr std::int64_t format_version = 1;

Results read_content(const H5File& file, const H5Group& group) {
    Results results;
    const json text = parse_json(group.text("description"), file.name());
    results.source = info_from_json(text.at("source"), file.name());
    results.label = text.at("label").get<std::string>();
    results.box = box_from_json(text.at("box"), file.name());
    results.frames = whole_from_json<std::int64_t>(text.at("frames"));
    results.particles_mean = number_from_json(text.at("particles_mean"));
    results.observables = read_observables(group.group("curves"), text.at("observables"));
    results.previews = read_previews(group.group("previews"));
    results.record = record_from_json(parse_json(group.text("record"), file.name()), file.name());
    if (group.has("sources")) {  // not in files of version 0.1
        for (const json& record : parse_json(group.text("sources"), file.name())) {
            results.sources.push_back(record_from_json(record, file.name()));
        }
    }
    results.identity = text.contains("identity")
                           ? identity_from_json(text.at("identity"), file.name())
                           : legacy_identity(results);
    return results;
}

}  // namespace

void write_results(const std::filesystem::path& path, const Results& results, Overwrite overwrite) {
    write_results(OutputFile(path, overwrite), results);
}

void write_results(OutputFile output, const Results& results) {
    H5File file = H5File::create(output.temporary(), output.target().string());
    require_rectangular(results.observables, file);
    const H5Group group = H5Group::root(file).make_group("results");
    group.set_attribute("version", format_version);

    json observables = write_observables(group.make_group("curves"), results.observables);
    const json description{{"source", to_json(results.source)},
                           {"identity", to_json(results.identity)},
                           {"label", results.label},
                           {"box", to_json(results.box)},
                           {"frames", results.frames},
                           {"particles_mean", io::to_json(results.particles_mean)},
                           {"observables", std::move(observables)}};
    group.write_text("description", text_of(description));
    group.write_text("record", text_of(to_json(results.record)));
    json sources = json::array();
    for (const RunRecord& record : results.sources) sources.push_back(to_json(record));
    group.write_text("sources", text_of(sources));
    const H5Group previews = group.make_group("previews");
    for (std::size_t i = 0; i < results.previews.size(); ++i) {
        write_preview(previews, std::to_string(i), results.previews[i]);
    }
    store_digest(file);
    file.close();
    output.commit();
}

Results read_results(const std::filesystem::path& path) {
    const H5File file = H5File::open(path);
    const H5Group root = H5Group::root(file);
    if (!root.has("results")) {
        file.fail("there are no results in it", "a file of 'grainfield analyze'");
    }
    const H5Group group = root.group("results");
    if (const double version = group.number_attribute("version"); version != format_version) {
        file.fail(fmt::format("results of format version {}", version),
                  fmt::format("version {}", format_version));
    }
    try {
        return read_content(file, group);
    } catch (const json::exception& error) {
        file.fail(fmt::format("the description is damaged ({})", error.what()));
    }
}

}  // namespace grainfield::io
