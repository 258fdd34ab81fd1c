#include "io/h5/results_file.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/readers.h"

namespace grainfield::fuzz {

bool read_results(std::string_view bytes) {
    const Input input(bytes, ".h5");
    return is_taken(input, [&] {
        const Results results = io::read_results(input.path());
        for (const ObservableResult& observable : results.observables) {
            for (const Curve& curve : observable.curves) {
                for (const Column& column : curve.columns) {
                    promise(column.values.size() == curve.columns.front().values.size(),
                            "the columns of a curve have one length");
                }
            }
        }
    });
}

}  // namespace grainfield::fuzz
