"""Figures for print: from the strips of `figures.drawing` to PDF, SVG and PNG by matplotlib, and to TikZ.

sheet(drawing, settings, about)     choose curves and panels, give line styles, reduce points: a value that can be sent
printed(sheet, "pdf")               bytes of a file; matplotlib is imported by this call
"""
