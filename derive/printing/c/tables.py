"""The law by a table in C99: what `sebody.kernels.tables.table_law` is for compiled kernels."""

from sebody.kernels.tables import HEAD, TERMS

TABLE_LAW = f"""
static double table_law(const double *table, double u, int64_t order) {{
    int64_t low = 0, high = (int64_t)table[0];
    const int above = u > table[{HEAD} + {TERMS}*high];
    const int below = u <= table[{HEAD}];
    if (above) {{
        low = high;
    }}
    while (!above && !below && high - low > 1) {{
        int64_t middle = (low + high)/2;
        if (u > table[{HEAD} + {TERMS}*middle]) {{
            low = middle;
        }} else {{
            high = middle;
        }}
    }}
    const double *row = table + {HEAD} + {TERMS}*low;
    double x = u - row[0], slope = below ? table[1] : row[2];
    double b = above || below ? 0.0 : row[3], c = above || below ? 0.0 : row[4];
    if (order == 2) {{
        return slope + x*(2.0*b + 3.0*c*x);
    }}
    if (order == 1) {{
        return row[1] + x*(slope + x*(b + c*x));
    }}
    return row[5] + x*(row[1] + x*(slope/2.0 + x*(b/3.0 + c*x/4.0)));
}}
"""
