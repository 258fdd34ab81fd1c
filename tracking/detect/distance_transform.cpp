#include "tracking/detect/distance_transform.h"

#include <algorithm>
#include <vector>

namespace grainfield::tracking {
namespace {

/// Lower envelope of the parabolas f(q) + (p − q)², in place, stride 1.
class ParabolaEnvelope {
 public:
    explicit ParabolaEnvelope(int longest)
        : vertex_(static_cast<std::size_t>(longest)),
          border_(static_cast<std::size_t>(longest) + 1),
          copy_(static_cast<std::size_t>(longest)) {}

    void apply(float* f, int n) {
        int k = 0;
        vertex_[0] = 0;
        border_[0] = -1e20F;
        border_[1] = 1e20F;
        for (int q = 1; q < n; ++q) {
            float s = crossing(f, q, vertex_[static_cast<std::size_t>(k)]);
            while (s <= border_[static_cast<std::size_t>(k)]) {
                --k;
                s = crossing(f, q, vertex_[static_cast<std::size_t>(k)]);
            }
            ++k;
            vertex_[static_cast<std::size_t>(k)] = q;
            border_[static_cast<std::size_t>(k)] = s;
            border_[static_cast<std::size_t>(k) + 1] = 1e20F;
        }
        k = 0;
        for (int p = 0; p < n; ++p) {
            while (border_[static_cast<std::size_t>(k) + 1] < static_cast<float>(p)) ++k;
            const int q = vertex_[static_cast<std::size_t>(k)];
            const auto d = static_cast<float>(p - q);
            copy_[static_cast<std::size_t>(p)] = d * d + f[q];
        }
        std::copy_n(copy_.begin(), n, f);
    }

 private:
    static float crossing(const float* f, int q, int v) {
        const auto fq = static_cast<float>(q);
        const auto fv = static_cast<float>(v);
        return ((f[q] + fq * fq) - (f[v] + fv * fv)) / (2 * (fq - fv));
    }

    std::vector<int> vertex_;
    std::vector<float> border_;
    std::vector<float> copy_;
};

}  // namespace

Image squared_distance_transform(const Image& mask) {
    const int w = mask.width();
    const int h = mask.height();
    const float far = static_cast<float>(w + h) * static_cast<float>(w + h);
    Image distance(w, h);
    for (std::size_t i = 0; i < mask.size(); ++i) {
        distance.pixels()[i] = mask.pixels()[i] > 0.5F ? far : 0.0F;
    }
    ParabolaEnvelope envelope(std::max(w, h));
    for (int y = 0; y < h; ++y) envelope.apply(distance.row(y), w);
    std::vector<float> column(static_cast<std::size_t>(h));
    for (int x = 0; x < w; ++x) {
        for (int y = 0; y < h; ++y) column[static_cast<std::size_t>(y)] = distance(x, y);
        envelope.apply(column.data(), h);
        for (int y = 0; y < h; ++y) distance(x, y) = column[static_cast<std::size_t>(y)];
    }
    for (float& d : distance.pixels()) d = std::min(d, far);
    return distance;
}

}  // namespace grainfield::tracking
