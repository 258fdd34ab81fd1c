#include "tracking/refine/joint_covariance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include "core/support/parallel.h"

namespace grainfield::tracking {
namespace {

constexpr double kSettled = 0.03;  // relative change of the error that ends the search
constexpr std::size_t kChunk = 256;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

using Block = Eigen::Matrix2d;

Block block_of(const NormalEquations& n) {
    Block block;
    block << n.xx, n.xy, n.xy, n.yy;
    return block;
}

Block block_of(const CrossBlock& c) {
    Block block;
    block << c.xx, c.xy, c.yx, c.yy;
    return block;
}

Block inverse_of(const Block& m) {
    Block result;
    result << m(1, 1), -m(0, 1), -m(1, 0), m(0, 0);
    return result / (m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0));
}

/// What is left of the information about one disc when its neighbours are unknown too: they are
/// eliminated one by one, block by block, those not coupled to one another skipped. Kept from disc
/// to disc to save allocations.
class Neighbourhood {
 public:
    explicit Neighbourhood(std::size_t discs) : local_(discs, kFar) {}

    /// Disc i and those coupled to it. Zero if they are not determined.
    Block shell(const JointInformation& info, std::uint32_t i) {
        gather(info, i);
        fill(info);
        return last_block();
    }

    /// After shell(): those coupled to the shell are unknown as well, each eliminated as if it were
    /// coupled to no other disc.
    Block second_shell(const JointInformation& info) {
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
            eliminate_outer(info, k);
            local_[k] = kFar;
        }
        return last_block();
    }

 private:
    static constexpr int kFar = -1;
    static constexpr int kOuter = -2;

    std::size_t at(std::size_t row, std::size_t column) const {
        return row * members_.size() + column;
    }

    void gather(const JointInformation& info, std::uint32_t i) {
        for (const std::uint32_t member : members_) local_[member] = kFar;
        members_.clear();
        for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
            members_.push_back(info.entry[e].other);
        }
        members_.push_back(i);
        for (std::size_t k = 0; k < members_.size(); ++k) {
            local_[members_[k]] = static_cast<int>(k);
        }
        blocks_.resize(members_.size() * members_.size());
    }

    /// The lower triangle.
    void fill(const JointInformation& info) {
        is_filled_.assign(blocks_.size(), 0);
        for (std::size_t k = 0; k < members_.size(); ++k) {
            const std::uint32_t m = members_[k];
            subtract(k, k, -block_of(info.own[m]));
            for (std::size_t e = info.begin[m]; e < info.begin[m + 1]; ++e) {
                const int column = local_[info.entry[e].other];
                if (column >= 0 && static_cast<std::size_t>(column) < k) {
                    subtract(k, static_cast<std::size_t>(column), -block_of(info.entry[e].block));
                }
            }
        }
    }

    void subtract(std::size_t row, std::size_t column, const Block& block) {
        const std::size_t place = at(row, column);
        if (is_filled_[place]) {
            blocks_[place] -= block;
        } else {
            blocks_[place] = -block;
            is_filled_[place] = 1;
        }
    }

    void eliminate_outer(const JointInformation& info, std::uint32_t k) {
        const Block inverse = inverse_of(block_of(info.own[k]));
        for (std::size_t e = info.begin[k]; e < info.begin[k + 1]; ++e) {
            const int one = local_[info.entry[e].other];
            if (one < 0) continue;
            const Block left = block_of(info.entry[e].block).transpose() * inverse;
            for (std::size_t f = info.begin[k]; f < info.begin[k + 1]; ++f) {
                const int other = local_[info.entry[f].other];
                if (other < 0 || other > one) continue;
                subtract(static_cast<std::size_t>(one), static_cast<std::size_t>(other),
                         left * block_of(info.entry[f].block));
            }
        }
    }

    /// The Schur complement of all members but the last.
    Block last_block() {
        const std::size_t last = members_.size() - 1;
        for (std::size_t k = 0; k < last; ++k) {
            const Block& pivot = blocks_[at(k, k)];
            if (!(pivot.determinant() > 0 && pivot(0, 0) > 0)) return Block::Zero();
            const Block inverse = inverse_of(pivot);
            for (std::size_t r = k + 1; r <= last; ++r) {
                if (!is_filled_[at(r, k)]) continue;
                const Block left = blocks_[at(r, k)] * inverse;
                for (std::size_t c = k + 1; c <= r; ++c) {
                    if (is_filled_[at(c, k)]) subtract(r, c, left * blocks_[at(c, k)].transpose());
                }
            }
        }
        const Block& rest = blocks_[at(last, last)];
        return rest.determinant() > 0 && rest(0, 0) > 0 ? rest : Block::Zero();
    }

    std::vector<int> local_;
    std::vector<std::uint32_t> members_, outer_;
    std::vector<Block> blocks_;
    std::vector<char> is_filled_;
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
void solve_together(const JointInformation& info, const std::vector<char>& is_strong,
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
        put(number[i], number[i], block_of(info.own[i]));
        for (std::size_t e = info.begin[i]; e < info.begin[i + 1]; ++e) {
            const int column = number[info.entry[e].other];
            if (column >= 0 && column < number[i])
                put(number[i], column, block_of(info.entry[e].block));
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

std::vector<PositionCovariance> joint_covariance(const JointInformation& info, int threads) {
    const std::size_t n = info.own.size();
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
            const double alone = error(block_of(info.own[i]));
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
