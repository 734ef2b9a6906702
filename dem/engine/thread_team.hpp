#pragma once
// A fixed team of threads for loops that are repeated millions of times. Work is cut into blocks of fixed size, so
// that what a block sums does not depend on the number of threads; totals are then added in block order.

#include <functional>
#include <memory>

namespace grainlaw::dem {

class ThreadTeam {
 public:
  /// `threads` >= 1, the caller's thread included. Throws Error when the system does not start as many.
  explicit ThreadTeam(int threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int threads() const;

  /// Calls body(block) once for each block in [0, blocks), blocks < 2^32, equal blocks from equal threads unless one is late, whose blocks
  /// others take; returns when all are done. An exception thrown by `body` is rethrown here (the first one).
  void for_each_block(std::size_t blocks, const std::function<void(std::size_t)>& body);

 private:
  struct Crew;
  std::unique_ptr<Crew> crew_;
};

inline constexpr std::size_t kBlockSize = 256;  ///< spheres per block; part of the definition of the sums

inline std::size_t block_count(std::size_t n) { return (n + kBlockSize - 1) / kBlockSize; }

}  // namespace grainlaw::dem
