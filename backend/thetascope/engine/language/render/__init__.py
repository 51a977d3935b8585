"""The mathematics in other forms: MathML for reading."""
