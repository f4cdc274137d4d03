// k-means by code length: `fit` makes a model of items, `cost` is what an item takes in a model.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace gicodec::train {

using Items = std::vector<std::size_t>;  ///< by number, ascending

/// The model that codes an item in least space.
struct Choice {
  std::size_t model = 0;
  double least = std::numeric_limits<double>::infinity();
  double next = least;  ///< without that model

  template <typename Cost, typename Model>
  Choice(std::size_t item, const Cost& cost, const std::vector<Model>& models) {
    for (std::size_t k = 0; k < models.size(); ++k) {
      const double c = cost(item, models[k]);
      if (c < least) {
        next = std::exchange(least, c);
        model = k;
      } else {
        next = std::min(next, c);
      }
    }
  }
};

/// Gives each item to the model that codes it in least space, fits the models to what they got, and
/// so on. Returns what each was fitted to, as far as there are items for it.
template <typename Fit, typename Cost, typename Model>
std::vector<Items> settle(std::size_t items, const Fit& fit, const Cost& cost,
                          std::vector<Model>& models) {
  constexpr unsigned kMaxRounds = 30;
  std::vector<Items> before(models.size());
  for (unsigned round = 0; round < kMaxRounds; ++round) {
    std::vector<Items> owned(models.size());
    for (std::size_t i = 0; i < items; ++i) owned[Choice(i, cost, models).model].push_back(i);
    if (owned == before) break;
    for (std::size_t k = 0; k < models.size(); ++k) {
      if (!owned[k].empty() && owned[k] != before[k]) models[k] = fit(owned[k]);
    }
    before = std::move(owned);
  }
  return before;
}

/// Opens the model that is missed least anew, with one of the items that are served worst against
/// `own`. False if that does not help.
template <typename Fit, typename Cost, typename Model>
bool reopen(const std::vector<double>& own, const Fit& fit, const Cost& cost,
            std::vector<Model>& models) {
  constexpr std::size_t kTries = 6;
  constexpr double kWorth = 1e-5;
  std::vector<double> loss(own.size()), missed(models.size());
  double sum = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Choice choice(i, cost, models);
    loss[i] = choice.least - own[i];
    missed[choice.model] += choice.next - choice.least;
    sum += choice.least;
  }
  const auto idle = std::min_element(missed.begin(), missed.end()) - missed.begin();
  Items worst(own.size());
  std::iota(worst.begin(), worst.end(), std::size_t{0});
  std::sort(worst.begin(), worst.end(), [&](auto a, auto b) { return loss[a] > loss[b]; });
  worst.resize(std::min(worst.size(), kTries));
  for (const auto item : worst) {
    auto trial = models;
    trial[idle] = fit(Items{item});
    settle(own.size(), fit, cost, trial);
    double then = 0;
    for (std::size_t i = 0; i < own.size(); ++i) then += Choice(i, cost, trial).least;
    if (then >= sum * (1 - kWorth)) continue;
    models = std::move(trial);
    return true;
  }
  return false;
}

/// `count` models. They begin as one of everything and, one at a time, one of the item that those
/// before serve worst against its own.
template <typename Fit, typename Cost>
auto cluster(std::size_t items, std::size_t count, const Fit& fit, const Cost& cost) {
  Items all(items);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector models{fit(all)};
  if (items == 0) return std::vector(count, models[0]);
  std::vector<double> own, loss;
  for (const auto i : all) {
    own.push_back(cost(i, fit(Items{i})));
    loss.push_back(cost(i, models[0]) - own[i]);
  }
  while (models.size() < count) {
    const auto worst = std::max_element(loss.begin(), loss.end()) - loss.begin();
    models.push_back(fit(Items{static_cast<std::size_t>(worst)}));
    for (const auto i : all) loss[i] = std::min(loss[i], cost(i, models.back()) - own[i]);
  }
  settle(items, fit, cost, models);
  while (reopen(own, fit, cost, models)) {
  }
  return models;
}

}  // namespace gicodec::train
