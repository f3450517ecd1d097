/* In place of mjlib's header of this name, for who has moteus alone. */
#pragma once

namespace mjlib::base
{

template <typename T> T Limit(T x, T low, T high)
{
    return x < low ? low : high < x ? high : x;
}

} // namespace mjlib::base
