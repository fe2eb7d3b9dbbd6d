"""`python -m mjcompose` is `mjcompose`."""

if __name__ == "__main__":
    from mjcompose.cli.entry import main

    main()
