#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/order/phase.h"
#include "core/results.h"

namespace grainfield::analysis {

/// |Q4| of one typical solid and one typical liquid particle through one averaging time T_o: the
/// curve `q4_examples` (text column `phase`) of the
/// observable "phase" (`castillo2019`, supplementary information).
///
/// Typical: among the particles that have a |Q4| in every frame of the window, the one whose mean
/// is nearest to the median mean of its class; of two alike the smaller identity. The window: the
/// first with a solid and a liquid particle, else the first with either. Once it is found nothing
/// is kept or compared any more.
///
/// Memory: 12 B a particle and frame of the open window. Windows of more than `most_values`
/// particles times frames, and of fewer than `least_frames` frames, are passed over.
class OrderExamples {
 public:
    static constexpr std::size_t most_values = 20'000'000;
    static constexpr std::size_t least_frames = 8;

    explicit OrderExamples(const PhaseOptions& options) : options_(options) {}

    /// Whether a later window could still change the answer.
    bool wants_more() const { return !(chosen_ && chosen_->solid && chosen_->liquid); }

    /// A frame of the open window.
    void add(PhaseHistory::Sample sample);
    /// The frames added since the last call are a window.
    void close_window();
    /// Adds what another found in later windows; both have closed their last one.
    void merge(const OrderExamples& later);
    /// Appends the curve, or a measurement with the reason why there is none.
    void add_to(ObservableResult& result) const;

 private:
    struct Series {
        std::int64_t id = 0;
        std::vector<double> abs_q;
    };
    struct Chosen {
        std::vector<double> time;  // from the first frame of the window
        std::optional<Series> solid, liquid;
    };
    Series series_of(std::int64_t id) const;

    PhaseOptions options_;
    std::vector<PhaseHistory::Sample> window_;
    std::size_t values_ = 0;
    bool too_large_ = false;
    std::size_t longest_ = 0;  // frames of the longest window
    std::optional<Chosen> chosen_;
};

}  // namespace grainfield::analysis
