// One visitor of a variant from several lambdas, a case each.
#pragma once

namespace evo {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace evo
