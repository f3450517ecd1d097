// KissFFT's header behind the C interface of fourier.h. Memory running out on a few thousand factors may end the program.
#include "fourier.h"

#include <kissfft/kissfft.hh>

#include <complex>
#include <new>

struct fourier {
    kissfft<double> transform{1, false};
};

fourier *fourier_new(void)
{
    return new (std::nothrow) fourier;
}

void fourier_forward(fourier *f, size_t n, const fourier_number *from, fourier_number *to)
{
    f->transform.assign(n, false); // nothing to do if the length is still the same
    // A complex number is laid out as its two parts.
    f->transform.transform(reinterpret_cast<const std::complex<double> *>(from),
                           reinterpret_cast<std::complex<double> *>(to));
}

void fourier_free(fourier *f)
{
    delete f;
}
