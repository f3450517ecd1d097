/* What was learned of an effect without a name, over what its strongest term depends on. */
#include "figures.h"

bool figure_learned(page *p, const evidence *v, error *e)
{
    const diagnosis_learned *l = &v->d->learned;
    plot drawing;
    if (!plot_begin(&drawing, 560, 380, e)) {
        return false;
    }
    plot_data(&drawing, "learned");
    for (size_t n = 0; n < l->points; n++) {
        plot_say(&drawing, "%.6g %.6g %.6g\n", l->point[n].x, l->point[n].left, l->point[n].learned);
    }
    plot_data_end(&drawing);
    plot_say(&drawing,
             "set xlabel '%s' noenhanced\nset ylabel 'missing %s (mean)' noenhanced\n%s"
             "set key at graph 1,1.11 right horizontal maxrows 1 samplen 1.2 width -1 font ',12'\nset "
             "tmargin 2.5\n"
             "plot $learned using 1:2 with points linestyle 2 title 'left over', "
             "$learned using 1:3 with lines linestyle 1 title 'learned'\n",
             l->axis, l->voltage, l->turns ? "set xrange [0:360]\nset xtics 60\n" : "");
    return page_figure(
        p, &drawing, "learned",
        "What the extended model leaves and what was learned of it, over what the strongest term "
        "depends on: means over rows that were not fitted.",
        e);
}
