#include "sparse_factor.h"

#include <algorithm>
#include <limits>
#include <queue>

#include "anthesis/base/assert.h"

namespace anthesis {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// The order is given up when L has become so much larger than it was when it was found.
constexpr double kMostGrowth = 1.25;

}  // namespace

std::vector<std::uint32_t> minimum_degree_order(std::size_t size, std::span<const UnknownPair> pairs) {
  // An eliminated unknown is an element: the set of unknowns that it joined. Neighbours of an unknown are those left in
  // the matrix and the members of its elements; so no clique is ever written out.
  std::vector<std::vector<std::uint32_t>> neighbours(size);
  std::vector<std::vector<std::uint32_t>> elements(size);
  std::vector<std::vector<std::uint32_t>> members(size);
  for (const UnknownPair& pair : pairs) {
    neighbours[pair[0]].push_back(pair[1]);
    neighbours[pair[1]].push_back(pair[0]);
  }
  struct Candidate {
    std::size_t degree;
    std::uint32_t unknown;
    std::size_t turn;
    bool operator>(const Candidate& other) const {
      return degree != other.degree ? degree > other.degree : turn < other.turn;
    }
  };
  std::vector<std::size_t> degree(size);
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  for (std::uint32_t i = 0; i < size; ++i) {
    degree[i] = neighbours[i].size();
    candidates.push({degree[i], i, i});
  }
  std::size_t turns = size;
  std::vector<std::uint32_t> place(size, kNone);
  std::vector<std::uint32_t> seen(size, kNone);
  std::vector<std::uint32_t> weighed(size, kNone);
  std::vector<std::size_t> beyond(size, 0);  // of an element: members outside the new one
  for (std::uint32_t step = 0; step < size;) {
    const Candidate candidate = candidates.top();
    candidates.pop();
    const std::uint32_t pivot = candidate.unknown;
    if (place[pivot] != kNone || candidate.degree != degree[pivot]) {
      continue;  // a newer one is or was in the queue
    }
    place[pivot] = step++;
    std::vector<std::uint32_t>& joined = members[pivot];
    const auto join = [&](std::uint32_t i) {
      if (place[i] == kNone && seen[i] != pivot) {
        seen[i] = pivot;
        joined.push_back(i);
      }
    };
    std::for_each(neighbours[pivot].begin(), neighbours[pivot].end(), join);
    for (const std::uint32_t e : elements[pivot]) {
      std::for_each(members[e].begin(), members[e].end(), join);
      members[e].clear();  // all of it is in the new element
    }
    for (const std::uint32_t i : joined) {
      for (const std::uint32_t e : elements[i]) {
        if (weighed[e] != pivot) {
          weighed[e] = pivot;
          beyond[e] = members[e].size();
        }
        beyond[e] -= beyond[e] > 0 ? 1 : 0;
      }
    }
    for (const std::uint32_t i : joined) {
      const auto is_known = [&](std::uint32_t j) { return place[j] != kNone || seen[j] == pivot; };
      neighbours[i].erase(std::remove_if(neighbours[i].begin(), neighbours[i].end(), is_known), neighbours[i].end());
      const auto is_absorbed = [&](std::uint32_t e) { return beyond[e] == 0; };
      elements[i].erase(std::remove_if(elements[i].begin(), elements[i].end(), is_absorbed), elements[i].end());
      degree[i] = neighbours[i].size() + joined.size() - 1;
      for (const std::uint32_t e : elements[i]) {
        degree[i] += beyond[e];
      }
      elements[i].push_back(pivot);
      candidates.push({degree[i], i, turns++});
    }
    neighbours[pivot] = {};
    elements[pivot] = {};
  }
  return place;
}

void SparseFactor::order(std::size_t size, std::span<const UnknownPair> pairs) {
  place_ = minimum_degree_order(size, pairs);
  find_structure(pairs);
  ordered_entries_ = entries();
}

void SparseFactor::analyse(std::span<const UnknownPair> pairs) {
  find_structure(pairs);
  if (static_cast<double>(entries()) > kMostGrowth * static_cast<double>(ordered_entries_)) {
    order(size(), pairs);
  }
}

void SparseFactor::find_structure(std::span<const UnknownPair> pairs) {
  const std::size_t n = size();
  row_begin_.assign(n + 1, 0);
  for (const UnknownPair& pair : pairs) {
    ++row_begin_[std::max(place_[pair[0]], place_[pair[1]])];
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : row_begin_) {
    sum += begin;
    begin = sum;  // for now the end; filling backwards makes it the beginning
  }
  row_entries_.resize(pairs.size());
  for (std::size_t k = pairs.size(); k-- > 0;) {
    const std::uint32_t a = place_[pairs[k][0]];
    const std::uint32_t b = place_[pairs[k][1]];
    row_entries_[--row_begin_[std::max(a, b)]] = {std::min(a, b), static_cast<std::uint32_t>(k)};
  }

  // A row of L has the columns of the matrix's row and all their ancestors below the row in the elimination tree
  // (Liu 1990), which grows along with it. Paths are put before those found earlier: then each column stands before
  // those it changes.
  parent_.assign(n, kNone);
  mark_.assign(n, kNone);
  next_.assign(n, 0);
  fill_begin_.assign(n + 1, 0);
  fill_.clear();
  std::vector<std::uint32_t> row(n);
  std::vector<std::uint32_t> path;
  for (std::uint32_t k = 0; k < n; ++k) {
    mark_[k] = k;
    std::size_t top = n;
    for (std::uint32_t e = row_begin_[k]; e < row_begin_[k + 1]; ++e) {
      path.clear();
      for (std::uint32_t i = row_entries_[e].column; mark_[i] != k; i = parent_[i]) {
        mark_[i] = k;
        path.push_back(i);
        if (parent_[i] == kNone) {
          parent_[i] = k;
        }
      }
      top -= path.size();
      std::copy(path.begin(), path.end(), row.begin() + static_cast<std::ptrdiff_t>(top));
    }
    for (; top < n; ++top) {
      fill_.push_back({row[top], next_[row[top]]++});
    }
    fill_begin_[k + 1] = static_cast<std::uint32_t>(fill_.size());
  }
  ANTHESIS_ASSERT(fill_.size() < kNone);
  column_begin_.resize(n + 1);
  column_begin_[0] = 0;
  for (std::size_t j = 0; j < n; ++j) {
    column_begin_[j + 1] = column_begin_[j] + next_[j];
  }
  rows_.resize(fill_.size());
  for (std::uint32_t k = 0; k < n; ++k) {
    for (std::uint32_t f = fill_begin_[k]; f < fill_begin_[k + 1]; ++f) {
      fill_[f].slot += column_begin_[fill_[f].column];
      rows_[fill_[f].slot] = k;
    }
  }
}

void SparseFactor::factorise(std::span<const double> diagonal, std::span<const double> below) {
  const std::size_t n = size();
  values_.resize(rows_.size());
  per_diagonal_.resize(n);
  row_.assign(n, 0.0);
  // next_ holds the diagonal's places here: unknowns by place.
  for (std::uint32_t i = 0; i < n; ++i) {
    next_[place_[i]] = i;
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (std::uint32_t e = row_begin_[k]; e < row_begin_[k + 1]; ++e) {
      row_[row_entries_[e].column] = below[row_entries_[e].pair];
    }
    double pivot = diagonal[next_[k]];
    for (std::uint32_t f = fill_begin_[k]; f < fill_begin_[k + 1]; ++f) {
      const auto [column, slot] = fill_[f];
      const double value = row_[column];
      row_[column] = 0.0;
      for (std::uint32_t e = column_begin_[column]; e < slot; ++e) {
        row_[rows_[e]] -= values_[e] * value;
      }
      const double share = value * per_diagonal_[column];
      pivot -= share * value;
      values_[slot] = share;
    }
    ANTHESIS_ASSERT(pivot > 0.0);
    per_diagonal_[k] = 1.0 / pivot;
  }
}

template <std::size_t kWidth>
void SparseFactor::solve(std::span<double> block, std::span<double> scratch) const {
  const std::size_t n = size();
  double* y = scratch.data();
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(&block[i * kWidth], kWidth, y + std::size_t{place_[i]} * kWidth);
  }
  for (std::size_t j = 0; j < n; ++j) {
    double known[kWidth];
    std::copy_n(y + j * kWidth, kWidth, known);
    for (std::uint32_t e = column_begin_[j]; e < column_begin_[j + 1]; ++e) {
      double* row = y + std::size_t{rows_[e]} * kWidth;
      for (std::size_t k = 0; k < kWidth; ++k) {
        row[k] -= values_[e] * known[k];
      }
    }
  }
  for (std::size_t j = n; j-- > 0;) {
    double sum[kWidth];
    for (std::size_t k = 0; k < kWidth; ++k) {
      sum[k] = y[j * kWidth + k] * per_diagonal_[j];
    }
    for (std::uint32_t e = column_begin_[j]; e < column_begin_[j + 1]; ++e) {
      const double* row = y + std::size_t{rows_[e]} * kWidth;
      for (std::size_t k = 0; k < kWidth; ++k) {
        sum[k] -= values_[e] * row[k];
      }
    }
    std::copy_n(sum, kWidth, y + j * kWidth);
  }
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(y + std::size_t{place_[i]} * kWidth, kWidth, &block[i * kWidth]);
  }
}

template void SparseFactor::solve<1>(std::span<double>, std::span<double>) const;
template void SparseFactor::solve<2>(std::span<double>, std::span<double>) const;
template void SparseFactor::solve<8>(std::span<double>, std::span<double>) const;

}  // namespace anthesis
