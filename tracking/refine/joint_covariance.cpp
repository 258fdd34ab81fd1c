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

namespace grainfield::tracking {
namespace {

constexpr double kWeakest = 1e-4;  // squared coupling below which a pair counts as independent
constexpr double kSettled = 0.03;  // relative change of the error that ends the search
constexpr double kHidden = 1e-6;   // of the information of an isolated disc
constexpr std::size_t kChunk = 256;
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

double smallest_eigenvalue(const Block& m) {
    const double half = 0.5 * m.trace();
    return half - std::hypot(0.5 * (m(0, 0) - m(1, 1)), m(0, 1));
}

Information information_of(const JointFit& fit, int threads) {
    const auto& positions = fit.positions();
    const DiscProfile& disc = fit.disc();
    Information info;
    info.diagonal.resize(positions.size(), Block::Zero());
    // Beyond, edges overlap by less than a thousandth of either's information.
    const double range = disc.diameter + 2.5 * disc.edge_width;
    PointGrid grid(fit.darkness().width(), fit.darkness().height(), range);
    for (std::uint32_t i = 0; i < positions.size(); ++i) grid.add(positions[i], i);
    std::vector<std::vector<Pair>> parts((positions.size() + kChunk - 1) / kChunk);
    parallel_for(static_cast<std::int64_t>(parts.size()), threads, [&](std::int64_t part) {
        std::vector<Pair>& pairs = parts[static_cast<std::size_t>(part)];
        std::vector<std::uint32_t> near;
        const std::size_t first = static_cast<std::size_t>(part) * kChunk;
        for (std::size_t k = first; k < std::min(positions.size(), first + kChunk); ++k) {
            const auto i = static_cast<std::uint32_t>(k);
            const JointFit::Information own = fit.information(i);
            info.diagonal[i] << own.xx, own.xy, own.xy, own.yy;
            near.clear();
            grid.near(positions[i], range, [&](std::uint32_t other, Vec2) {
                if (other > i) near.push_back(other);
            });
            std::sort(near.begin(), near.end());
            for (const std::uint32_t j : near) {
                const CrossBlock c = fit.coupling(i, j);
                Pair pair{i, j, {}};
                pair.block << c.xx, c.xy, c.yx, c.yy;
                pairs.push_back(pair);
            }
        }
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
    for (std::vector<Pair>& pairs : parts) {
        std::erase_if(pairs, [&](const Pair& pair) { return !is_coupled(pair); });
        for (const Pair& pair : pairs) {
            ++degree[pair.i];
            ++degree[pair.j];
        }
    }
    info.begin.assign(positions.size() + 1, 0);
    std::partial_sum(degree.begin(), degree.end(), info.begin.begin() + 1);
    info.entry.resize(info.begin.back());
    auto at = info.begin;
    for (const std::vector<Pair>& pairs : parts) {
        for (const Pair& pair : pairs) {
            info.entry[at[pair.i]++] = {pair.j, pair.block};
            info.entry[at[pair.j]++] = {pair.i, pair.block.transpose()};
        }
    }
    return info;
}

Block inverse_of(const Block& m) {
    Block result;
    result << m(1, 1), -m(0, 1), -m(1, 0), m(0, 0);
    return result / (m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0));
}

/// What is left of the information about one disc when its neighbours are unknown too. Kept from
/// disc to disc to save allocations.
class Neighbourhood {
 public:
    explicit Neighbourhood(std::size_t discs) : local_(discs, kFar) {}

    /// Disc i and those coupled to it, exactly: the last 2×2 block of the Cholesky factor, times
    /// its transpose. Zero if they are not determined.
    Block shell(const Information& info, std::uint32_t i) {
        gather(info, i);
        fill(info);
        return last_block();
    }

    /// After shell(): those coupled to the shell are unknown as well, each eliminated as if it were
    /// coupled to nobody else.
    Block second_shell(const Information& info) {
        fill(info);
        outer_.clear();
        const std::size_t shell = members_.size() - 1;
        for (std::size_t k = 0; k < shell; ++k) {
            const std::uint32_t m = members_[k];
            for (std::size_t e = info.begin[m]; e < info.begin[m + 1]; ++e) {
                const std::uint32_t other = info.entry[e].other;
                if (local_[other] != kFar) continue;
                local_[other] = kOuter;
                outer_.push_back(other);
            }
        }
        for (const std::uint32_t k : outer_) {
            eliminate(info, k);
            local_[k] = kFar;
        }
        return last_block();
    }

 private:
    static constexpr int kFar = -1;
    static constexpr int kOuter = -2;

    double* row(std::size_t r) { return matrix_.data() + r * 2 * members_.size(); }

    void gather(const Information& info, std::uint32_t i) {
        for (const std::uint32_t member : members_) local_[member] = kFar;
        members_.clear();
        for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
            members_.push_back(info.entry[e].other);
        }
        members_.push_back(i);
        for (std::size_t k = 0; k < members_.size(); ++k) {
            local_[members_[k]] = static_cast<int>(k);
        }
    }

    /// The lower triangle.
    void fill(const Information& info) {
        matrix_.assign(4 * members_.size() * members_.size(), 0.0);
        for (std::size_t k = 0; k < members_.size(); ++k) {
            const std::uint32_t m = members_[k];
            add(k, k, info.diagonal[m], 1);
            for (std::size_t e = info.begin[m]; e < info.begin[m + 1]; ++e) {
                const int column = local_[info.entry[e].other];
                if (column >= 0 && static_cast<std::size_t>(column) < k) {
                    add(k, static_cast<std::size_t>(column), info.entry[e].block, 1);
                }
            }
        }
    }

    void add(std::size_t k, std::size_t column, const Block& block, double sign) {
        double* upper = row(2 * k) + 2 * column;
        double* lower = row(2 * k + 1) + 2 * column;
        upper[0] += sign * block(0, 0);
        upper[1] += sign * block(0, 1);
        lower[0] += sign * block(1, 0);
        lower[1] += sign * block(1, 1);
    }

    void eliminate(const Information& info, std::uint32_t k) {
        const Block inverse = inverse_of(info.diagonal[k]);
        for (std::size_t e = info.begin[k]; e < info.begin[k + 1]; ++e) {
            const int one = local_[info.entry[e].other];
            if (one < 0) continue;
            const Block left = info.entry[e].block.transpose() * inverse;
            for (std::size_t f = info.begin[k]; f < info.begin[k + 1]; ++f) {
                const int other = local_[info.entry[f].other];
                if (other < 0 || other > one) continue;
                add(static_cast<std::size_t>(one), static_cast<std::size_t>(other),
                    left * info.entry[f].block, -1);
            }
        }
    }

    Block last_block() {
        const std::size_t n = 2 * members_.size();
        for (std::size_t r = 0; r < n; ++r) {
            double* here = row(r);
            for (std::size_t c = 0; c <= r; ++c) {
                const double* other = row(c);
                double sum = here[c];
                for (std::size_t k = 0; k < c; ++k) sum -= here[k] * other[k];
                if (c < r) {
                    here[c] = sum * other[c];
                } else {
                    if (!(sum > 0)) return Block::Zero();
                    // The diagonal is kept inverted.
                    here[c] = 1 / std::sqrt(sum);
                }
            }
        }
        Block last;
        last << 1 / row(n - 2)[n - 2], 0, row(n - 1)[n - 2], 1 / row(n - 1)[n - 1];
        return last * last.transpose();
    }

    std::vector<int> local_;
    std::vector<std::uint32_t> members_, outer_;
    std::vector<double> matrix_;
};

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
    const auto chunks = static_cast<std::int64_t>((n + kChunk - 1) / kChunk);
    parallel_for(chunks, threads, [&](std::int64_t chunk) {
        Neighbourhood around(n);
        const std::size_t first = static_cast<std::size_t>(chunk) * kChunk;
        for (std::size_t j = first; j < std::min(n, first + kChunk); ++j) {
            if (info.is_hidden[j]) continue;
            const auto i = static_cast<std::uint32_t>(j);
            Block near = around.shell(info, i);
            const double alone = error(info.diagonal[i]);
            // One shell raises the error; the next raise is smaller still, by about that factor.
            if (error(near) - alone > std::sqrt(kSettled) * alone) {
                const Block nearer = near;
                near = around.second_shell(info);
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
