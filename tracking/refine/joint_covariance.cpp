#include "tracking/refine/joint_covariance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include "core/parallel.h"
#include "tracking/point_grid.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

constexpr double kWeakest = 1e-4;   // squared coupling below which a pair counts as independent
constexpr double kSettled = 0.03;   // relative change of the error that ends the search
constexpr double kHidden = 1e-6;    // of the information of an isolated disc
constexpr double kBandHeight = 10;  // [reach]
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Block = Eigen::Matrix2d;

struct Pair {
    std::uint32_t i, j;
    Block block;  // Σ J_i J_jᵀ
};

/// The information matrix: diagonal blocks, and for each disc its coupled neighbours.
struct Information {
    std::vector<Block> diagonal;
    std::vector<std::size_t> begin;  // neighbours of i: entries [begin[i], begin[i + 1])
    struct Entry {
        std::uint32_t other;
        Block block;  // Σ J_i J_otherᵀ
    };
    std::vector<Entry> entry;
    std::vector<char> is_hidden;
};

struct Band {
    std::vector<std::uint32_t> own, all;
    std::vector<Pair> pairs;
};

/// Own discs in [top, top + height), and all those that may be coupled to them from below.
std::vector<Band> bands_of(const std::vector<Vec2>& positions, int image_height, double height,
                           double range) {
    std::vector<Band> bands(static_cast<std::size_t>(image_height / height) + 1);
    const auto last = static_cast<int>(bands.size()) - 1;
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        const double y = positions[i].y;
        const int own = std::clamp(static_cast<int>(y / height), 0, last);
        bands[static_cast<std::size_t>(own)].own.push_back(i);
        bands[static_cast<std::size_t>(own)].all.push_back(i);
        if (own > 0 && y - own * height <= range) {
            bands[static_cast<std::size_t>(own - 1)].all.push_back(i);
        }
    }
    return bands;
}

void sum_band(const JointFit& fit, double range, Band& band, std::vector<Block>& diagonal) {
    const auto& positions = fit.positions();
    // Kept from band to band: several megabytes of fresh pages would cost more than the sums.
    thread_local std::vector<DiscWindow> windows;
    thread_local std::vector<DiscGradient> gradients;
    if (windows.size() < band.all.size()) windows.resize(band.all.size());
    if (gradients.size() < band.all.size()) gradients.resize(band.all.size());
    PointGrid grid(fit.darkness().width(), fit.darkness().height(), range);
    for (std::size_t k = 0; k < band.all.size(); ++k) {
        gradient(fit.transmission(), positions[band.all[k]], fit.disc(), windows[k], gradients[k]);
        grid.add(positions[band.all[k]], static_cast<std::uint32_t>(k));
    }
    const auto comes_before = [&](std::uint32_t a, std::uint32_t b) {
        return positions[a].y != positions[b].y ? positions[a].y < positions[b].y : a < b;
    };
    std::size_t next = 0;
    std::vector<std::uint32_t> near;
    for (std::size_t k = 0; k < band.all.size(); ++k) {
        const std::uint32_t i = band.all[k];
        if (next == band.own.size() || band.own[next] != i) continue;
        ++next;
        const CrossBlock own = cross_block(windows[k], gradients[k], windows[k], gradients[k]);
        diagonal[i] << own.xx, own.xy, own.yx, own.yy;
        near.clear();
        grid.near(positions[i], range, [&](std::uint32_t other, Vec2) {
            if (comes_before(i, band.all[other])) near.push_back(other);
        });
        std::sort(near.begin(), near.end());
        for (const std::uint32_t other : near) {
            const CrossBlock c =
                cross_block(windows[k], gradients[k], windows[other], gradients[other]);
            Pair pair{i, band.all[other], {}};
            pair.block << c.xx, c.xy, c.yx, c.yy;
            band.pairs.push_back(pair);
        }
    }
}

double smallest_eigenvalue(const Block& m) {
    const double half = 0.5 * m.trace();
    return half - std::hypot(0.5 * (m(0, 0) - m(1, 1)), m(0, 1));
}

Information information_of(const JointFit& fit, int threads) {
    const auto& positions = fit.positions();
    const DiscProfile& disc = fit.disc();
    Information info;
    info.diagonal.resize(positions.size(), Block::Zero());
    const double range = disc.diameter + 4 * disc.edge_width;
    auto bands = bands_of(positions, fit.darkness().height(), kBandHeight * disc.reach(), range);
    parallel_for(static_cast<std::int64_t>(bands.size()), threads, [&](std::int64_t b) {
        sum_band(fit, range, bands[static_cast<std::size_t>(b)], info.diagonal);
    });

    const double isolated = std::numbers::pi * disc.diameter / (6 * disc.edge_width);
    for (const Block& block : info.diagonal) {
        info.is_hidden.push_back(!(smallest_eigenvalue(block) > kHidden * isolated));
    }
    std::vector<std::size_t> degree(positions.size(), 0);
    const auto is_coupled = [&](const Pair& pair) {
        return !info.is_hidden[pair.i] && !info.is_hidden[pair.j] &&
               4 * pair.block.squaredNorm() >
                   kWeakest * info.diagonal[pair.i].trace() * info.diagonal[pair.j].trace();
    };
    for (Band& band : bands) {
        std::erase_if(band.pairs, [&](const Pair& pair) { return !is_coupled(pair); });
        for (const Pair& pair : band.pairs) {
            ++degree[pair.i];
            ++degree[pair.j];
        }
    }
    info.begin.assign(positions.size() + 1, 0);
    std::partial_sum(degree.begin(), degree.end(), info.begin.begin() + 1);
    info.entry.resize(info.begin.back());
    auto at = info.begin;
    for (const Band& band : bands) {
        for (const Pair& pair : band.pairs) {
            info.entry[at[pair.i]++] = {pair.j, pair.block};
            info.entry[at[pair.j]++] = {pair.i, pair.block.transpose()};
        }
    }
    return info;
}

/// The discs within a number of steps of disc i, i itself last, and their local numbers.
class Shells {
 public:
    explicit Shells(std::size_t discs) : local_(discs, -1) {}

    const std::vector<std::uint32_t>& gather(const Information& info, std::uint32_t i, int steps) {
        for (const std::uint32_t member : members_) local_[member] = -1;
        members_.assign(1, i);
        local_[i] = 0;
        std::size_t shell = 0;
        for (int step = 0; step < steps; ++step) {
            const std::size_t end = members_.size();
            for (; shell < end; ++shell) {
                const std::uint32_t m = members_[shell];
                for (std::size_t e = info.begin[m]; e < info.begin[m + 1]; ++e) {
                    const std::uint32_t other = info.entry[e].other;
                    if (local_[other] >= 0) continue;
                    local_[other] = 0;
                    members_.push_back(other);
                }
            }
        }
        std::reverse(members_.begin(), members_.end());
        for (std::size_t k = 0; k < members_.size(); ++k) {
            local_[members_[k]] = static_cast<int>(k);
        }
        return members_;
    }
    int local(std::uint32_t i) const { return local_[i]; }

 private:
    std::vector<int> local_;
    std::vector<std::uint32_t> members_;
};

/// What is left of the information about disc i when its shells are unknown too: the last 2×2
/// block of the Cholesky factor, times its transpose. Zero if the shells are not determined.
Block marginal_information(const Information& info, std::uint32_t i, int steps, Shells& shells) {
    const auto& members = shells.gather(info, i, steps);
    const auto n = static_cast<Eigen::Index>(2 * members.size());
    if (members.size() == 1) return info.diagonal[i];
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t k = 0; k < members.size(); ++k) {
        const std::uint32_t m = members[k];
        const auto row = static_cast<Eigen::Index>(2 * k);
        matrix.block<2, 2>(row, row) = info.diagonal[m];
        for (std::size_t e = info.begin[m]; e < info.begin[m + 1]; ++e) {
            const int column = shells.local(info.entry[e].other);
            if (column >= 0) matrix.block<2, 2>(row, 2 * column) = info.entry[e].block;
        }
    }
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(matrix);
    if (factor.info() != Eigen::Success) return Block::Zero();
    const Eigen::Matrix2d last = matrix.bottomRightCorner<2, 2>().triangularView<Eigen::Lower>();
    return last * last.transpose();
}

PositionCovariance inverse(const Block& m) {
    const double determinant = m.determinant();
    if (!(determinant > 1e-12 * m.trace() * m.trace())) return {kNaN, kNaN, kNaN};
    return {m(1, 1) / determinant, -m(0, 1) / determinant, m(0, 0) / determinant};
}

double error(const Block& m) {
    const PositionCovariance c = inverse(m);
    return std::sqrt(c.xx + c.yy);
}

/// The entries of the inverse of L Lᵀ on the pattern of L, column by column from the last
/// (Takahashi):  Z_ij = δ_ij/L_jj² − Σ_{k>j} Z_ik L_kj / L_jj.
Eigen::SparseMatrix<double> selected_inverse(const Eigen::SparseMatrix<double>& l) {
    Eigen::SparseMatrix<double> z = l;
    std::vector<double> sums;
    std::vector<Eigen::Index> place(static_cast<std::size_t>(l.rows()), -1);
    const int* outer = l.outerIndexPtr();
    const int* inner = l.innerIndexPtr();
    const double* factor = l.valuePtr();
    double* value = z.valuePtr();
    for (Eigen::Index j = l.cols() - 1; j >= 0; --j) {
        const int first = outer[j];
        const int end = outer[j + 1];
        sums.assign(static_cast<std::size_t>(end - first), 0.0);
        for (int p = first + 1; p < end; ++p) place[static_cast<std::size_t>(inner[p])] = p - first;
        for (int p = first + 1; p < end; ++p) {
            const int k = inner[p];
            const double l_kj = factor[p];
            for (int q = outer[k]; q < outer[k + 1]; ++q) {
                const Eigen::Index at = place[static_cast<std::size_t>(inner[q])];
                if (at < 0) continue;
                sums[static_cast<std::size_t>(at)] += value[q] * l_kj;
                if (inner[q] != k) {
                    sums[static_cast<std::size_t>(p - first)] += value[q] * factor[first + at];
                }
            }
        }
        double diagonal = 1 / factor[first];
        for (int p = first + 1; p < end; ++p) {
            value[p] = -sums[static_cast<std::size_t>(p - first)] / factor[first];
            diagonal -= factor[p] * value[p];
        }
        value[first] = diagonal / factor[first];
        for (int p = first + 1; p < end; ++p) place[static_cast<std::size_t>(inner[p])] = -1;
    }
    return z;
}

/// Discs that a few shells do not determine, together with their neighbours, the rest held fixed.
void solve_together(const Information& info, const std::vector<char>& is_strong,
                    std::vector<PositionCovariance>& result) {
    std::vector<int> number(is_strong.size(), -1);
    int n = 0;
    for (std::uint32_t i = 0; i < is_strong.size(); ++i) {
        bool belongs = is_strong[i] != 0;
        for (std::size_t e = info.begin[i]; e < info.begin[i + 1] && !belongs; ++e) {
            belongs = is_strong[info.entry[e].other] != 0;
        }
        if (belongs) number[i] = n++;
    }
    if (n == 0) return;
    std::vector<Eigen::Triplet<double>> entries;
    const auto put = [&](int row, int column, const Block& block) {
        for (int a = 0; a < 2; ++a) {
            for (int b = 0; b < 2; ++b) {
                if (2 * row + a >= 2 * column + b) {
                    entries.emplace_back(2 * row + a, 2 * column + b, block(a, b));
                }
            }
        }
    };
    for (std::uint32_t i = 0; i < is_strong.size(); ++i) {
        if (number[i] < 0) continue;
        put(number[i], number[i], info.diagonal[i]);
        for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
            const int column = number[info.entry[e].other];
            if (column >= 0 && column < number[i]) put(number[i], column, info.entry[e].block);
        }
    }
    Eigen::SparseMatrix<double> matrix(2 * n, 2 * n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(matrix);
    const bool solved = factor.info() == Eigen::Success;
    Eigen::SparseMatrix<double> z;
    if (solved) z = selected_inverse(factor.matrixL());
    const auto& order = factor.permutationP().indices();
    for (std::uint32_t i = 0; i < is_strong.size(); ++i) {
        if (is_strong[i] == 0) continue;
        if (!solved) {
            result[i] = {kNaN, kNaN, kNaN};
            continue;
        }
        const auto x = order(2 * number[i]);
        const auto y = order(2 * number[i] + 1);
        result[i] = {z.coeff(x, x), z.coeff(std::max(x, y), std::min(x, y)), z.coeff(y, y)};
    }
}

}  // namespace

std::vector<PositionCovariance> joint_covariance(const JointFit& fit, int threads) {
    const Information info = information_of(fit, threads);
    const std::size_t n = info.diagonal.size();
    std::vector<PositionCovariance> result(n, {kNaN, kNaN, kNaN});
    std::vector<char> is_strong(n, 0);
    constexpr std::size_t kChunk = 256;
    const auto chunks = static_cast<std::int64_t>((n + kChunk - 1) / kChunk);
    parallel_for(chunks, threads, [&](std::int64_t chunk) {
        Shells shells(n);
        const std::size_t first = static_cast<std::size_t>(chunk) * kChunk;
        for (std::size_t j = first; j < std::min(n, first + kChunk); ++j) {
            if (info.is_hidden[j]) continue;
            const auto i = static_cast<std::uint32_t>(j);
            Block near = marginal_information(info, i, 1, shells);
            const double alone = error(info.diagonal[i]);
            // One shell raises the error; the next raise is smaller still, by about that factor.
            if (error(near) - alone > std::sqrt(kSettled) * alone) {
                const Block nearer = near;
                near = marginal_information(info, i, 2, shells);
                const double raise = error(near) / error(nearer) - 1;
                is_strong[j] = !(raise < kSettled);
            }
            result[j] = inverse(near);
        }
    });
    solve_together(info, is_strong, result);
    return result;
}

}  // namespace grainfield::tracking
